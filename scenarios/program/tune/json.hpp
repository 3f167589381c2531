#pragma once

#include <filesystem>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/tune/answer.hpp"

/// What `tune` answers as JSON.
namespace hapbench {

/// The answer as JSON; `tuned`: the file of the tuned scenario, empty for none.
Json tuning_json(const Tuning& tuning, const std::filesystem::path& tuned);
/// The scenario with the choice of a law, for a file in `out`.
Json tuned_scenario(const Tuning& tuning, const TunedLaw& law, const std::filesystem::path& out);

}  // namespace hapbench
