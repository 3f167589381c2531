#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/format/json_file.hpp"
#include "sim/core/types.hpp"

/// Scenario files to start from: each scene runs at once and touches something, and has only the fields that a newcomer
/// changes first.
namespace hapbench {

/// A kind of start.
struct StartKind {
  std::string name;
  std::string summary;
  std::string source;  ///< what it is made from: "mesh", "shell" or "stroke"; empty for nothing
  bool is_source_optional;
  Json scene;  ///< with what does not depend on the source
};

/// All kinds, those of scenarios/library/starts.json, in the order in which they are shown. Throws InputError without
/// that file.
const std::vector<StartKind>& start_kinds();

/// What a start is made from and where it starts, as far as it is said.
struct StartOptions {
  std::optional<std::filesystem::path> source = {};  ///< exactly where the kind wants one
  std::optional<std::filesystem::path> on = {};      ///< the mesh that a stroke is played back over
  std::optional<double> extent = {};                 ///< of the mesh: longest edge of its box [m]
  std::string side = "z";                            ///< from which the tool comes: x, y, z, -x, -y or -z
  std::vector<Vec3> path = {};                       ///< of a drag, two points or more [m]
  std::optional<Vec3> at = {};                       ///< the tool starts over the surface's place nearest to it [m]
};

/// A start.
struct ScenarioStart {
  Json scene;                      ///< of the scenario file
  std::vector<std::string> notes;  ///< sizes, guesses and choices, a line each
  std::vector<std::string> warnings;
};

/// Makes a start for a file in `directory`. A mesh has the size that is stated, or is in metres. Its points are a tenth
/// of the tool's diameter apart. The tool is 1 mm thick, or a fiftieth of a longer object, and starts 1 mm above the
/// middle of the highest places; a drag starts where it has room and covers most of it. Normals of an open mesh that
/// point away from the tool are turned round. The tip of a tool from a mesh is the file's origin. Throws InputError when a file cannot be used, and for a mesh of no stated
/// size that is not 1 mm to 1 m long in metres, with its length in metres and in millimetres.
ScenarioStart scenario_start(const StartKind& kind, const StartOptions& options,
                             const std::filesystem::path& directory);

}  // namespace hapbench
