#pragma once

#include <filesystem>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/tune/answer.hpp"

/// The JSON output of `tune`.
namespace hapbench {

/// Returns the results as JSON. `tuned`: path of the file with the tuned scenario; empty if there is no such file.
Json tuning_json(const Tuning& tuning, const std::filesystem::path& tuned);
/// Returns the scenario of the question with the choice of a law. The file paths in the returned scenario are relative
/// to the directory `out`.
Json tuned_scenario(const Tuning& tuning, const TunedLaw& law, const std::filesystem::path& out);

}  // namespace hapbench
