#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenarios/description/load_scenario.hpp"

/// Scenes sampled more finely: the overrides that do it, for --check, --sure and converge.
namespace hapbench {

/// The field that sets the distance of the shell's points, and this distance.
struct PointDistance {
  const char* path;  ///< of the field, as in --set
  double metres;
  bool is_given = true;  ///< false: the mean distance of the vertices of a mesh that is taken as it is
};

/// None where no field sets it.
std::optional<PointDistance> point_distance(const LoadedScenario& loaded);

/// The overrides of a scenario sampled more finely, and how a reader is told.
struct FinerScene {
  std::vector<std::string> overrides;  ///< none where it cannot be
  std::string change;                  ///< without overrides: why
};

/// Points so many times closer.
FinerScene with_finer_spacing(const LoadedScenario& loaded, int times);

/// A step so many times shorter, first among the overrides, over the same time; delays of devices keep their length.
FinerScene with_finer_step(const Scenario& scenario, int times);

}  // namespace hapbench
