#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/core/types.hpp"

/// Scenario files to start from: each scene runs at once and touches something, and has only the fields that a newcomer
/// changes first.
namespace hapbench {

/// The file that a start may be made from.
enum class StartSource { none, mesh, shell, stroke };

/// A kind of start.
struct StartKind {
  const char* name;
  const char* summary;
  StartSource source;
  bool needs_source;
  std::string sections;  ///< of the scenario file, a text in which @name@ stands for a value to be determined
  int steps = 2000;      ///< unless determined
};

/// All kinds, in the order in which they are shown.
const std::vector<StartKind>& start_kinds();

/// The sections of a kind on a mesh in place of its plane.
std::string on_mesh(const StartKind& kind);

/// What a start is made from and where it starts, as far as it is said.
struct StartOptions {
  std::optional<std::filesystem::path> source = {};  ///< exactly where the kind wants one
  std::optional<std::filesystem::path> on = {};      ///< the mesh that a stroke is played back over
  std::optional<double> extent = {};                 ///< of the mesh: longest edge of its box [m]
  std::string side = "z";                            ///< from which the tool comes: x, y, z, -x, -y or -z
  std::vector<Vec3> path = {};                       ///< of a drag, two points or more [m]
  std::optional<Vec3> at = {};                       ///< the tool starts over the surface's place nearest to it [m]
  std::string command = {};                          ///< that asks for this start, for a refusal; without --extent
};

/// A start.
struct ScenarioStart {
  std::string text;                ///< of the scenario file
  std::vector<std::string> notes;  ///< sizes, guesses and choices, a line each
  std::vector<std::string> warnings;
};

/// Makes a start for a file in `directory`. A mesh has the size that is stated, or is in metres. Its points are a tenth
/// of the tool's diameter apart. The tool is 1 mm thick, or a fiftieth of a longer object, and starts 1 mm above the
/// middle of the highest places; a drag starts where it has room and covers most of it. Normals of an open mesh that
/// point away from the tool are turned round. Throws InputError when a file cannot be used, and for a mesh of no stated
/// size that is not 1 mm to 1 m long in metres, with its length in metres and in millimetres.
ScenarioStart scenario_start(const StartKind& kind, const StartOptions& options,
                             const std::filesystem::path& directory);

}  // namespace hapbench
