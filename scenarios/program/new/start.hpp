#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/new/kinds.hpp"
#include "scenarios/program/new/options.hpp"

/// The scenes that the command `hapbench new` writes.
namespace hapbench {

/// A scenario to start from.
struct StartedScene {
  Json scene;                      ///< content of the scenario file
  std::vector<std::string> notes;  ///< texts about the sizes and values that were chosen, one line each
  std::vector<std::string> warnings;
};

/// Returns the scene of a kind, for a scenario file in `directory`. Throws InputError if a file of the options
/// cannot be used. Cost: seconds for a large mesh.
StartedScene started_scene(const StartKind& kind, const NewOptions& options, const std::filesystem::path& directory);

}  // namespace hapbench
