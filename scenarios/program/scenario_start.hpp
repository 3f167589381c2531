#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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

/// A start.
struct ScenarioStart {
  std::string text;                ///< of the scenario file
  std::vector<std::string> notes;  ///< guesses and choices, a line each
  std::vector<std::string> warnings;
};

/// Makes a start for a file in `directory`. A mesh gets the unit, of m, cm and mm, that brings its length closest to a
/// tooth's 10 mm, and points a tenth of the tool's diameter apart. The tool is 1 mm thick, or a fiftieth of a longer
/// object, and starts 1 mm above the middle of the highest places; a drag starts where it has room and covers most of
/// it. Precondition: a source exactly where the kind wants one. Throws InputError when it cannot be used.
ScenarioStart scenario_start(const StartKind& kind, const std::optional<std::filesystem::path>& source,
                             const std::filesystem::path& directory);

}  // namespace hapbench
