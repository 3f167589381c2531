#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// A scenario file to start from: a scene that runs at once and touches something, with only those fields that a
/// newcomer changes first.
namespace hapbench {

/// What a start may be made from.
enum class StartSource { none, mesh, shell, stroke };

/// A kind of start.
struct StartKind {
  const char* name;
  const char* summary;
  StartSource source;
  bool needs_source;
  std::string sections;  ///< of the file, as text in which @name@ stands for what is found out
  int steps = 2000;      ///< where they are not found out
};

/// All kinds, in the order in which they are shown.
const std::vector<StartKind>& start_kinds();

/// A start.
struct ScenarioStart {
  std::string text;                   ///< of the scenario file
  std::vector<std::string> notes;     ///< what was guessed and chosen, a line each
  std::vector<std::string> warnings;  ///< what it could not find
};

/// Makes a start that is to stand in `directory`. A mesh gets the unit, of m, cm and mm, that makes it most like a
/// tooth in size, 10 mm long, and points a tenth of the tool's diameter apart. The tool, 1 mm thick or a fiftieth of a
/// longer object, starts 1 mm above the middle of what is highest; a drag where it has room (drag_start.hpp), over most
/// of it. Precondition: a source exactly where the kind wants
/// one. Throws InputError when it cannot be used.
ScenarioStart scenario_start(const StartKind& kind, const std::optional<std::filesystem::path>& source,
                             const std::filesystem::path& directory);

}  // namespace hapbench
