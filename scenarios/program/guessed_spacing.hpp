#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "scenarios/input/json_file.hpp"

namespace hapbench {

/// What is known of a mesh's scene before the test.
struct SpacingTest {
  double diameter = 0.001;  ///< of the tool [m]
  double spacing = 0.0001;  ///< at which it has `points` [m]
  std::size_t points = 0;
};

/// The chosen distance of a mesh's points, and why.
struct GuessedSpacing {
  double spacing = 0.0;  ///< [m]
  std::string note;
};

/// Chooses environment.spacing_m of a scene as the widest of a fifth, a tenth, a twentieth and a fortieth of the tool's
/// diameter at half of which the columns that `compare` prints of shaped_stiffness, mean, proxy and summation do not
/// flip (judged_column) and mean force and depth of the scene's own law do not move by more than kHeld. Where none
/// passes whose half takes up to 250 000 points it is that of `test`. Runs the scene with the four laws up to five
/// times. `directory`: what its relative paths start from. Throws InputError and Stopped.
GuessedSpacing guessed_spacing(const Json& scene, const std::filesystem::path& directory, const SpacingTest& test);

}  // namespace hapbench
