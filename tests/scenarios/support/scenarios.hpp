#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

/// Scenarios for tests, and helpers for errors of invalid scenarios.
namespace hapbench::test {

struct NamedScenario {
  std::string name;
  Json json;
};

/// Returns a scenario for each environment type, with only the required fields.
std::vector<NamedScenario> minimal_scenarios();
/// Returns the minimal scenario of an environment type.
Json minimal_scenario(const std::string& environment_type);

/// Returns scenarios that together give every field of the schema a value, in valid combinations that the
/// bundled scenarios do not use. They name the files cube.obj, shell.csv, stroke.csv and trace.csv in
/// tests/data.
std::vector<NamedScenario> rich_scenarios();

/// Returns every bundled scenario, with inherited fields ("extends") filled in.
std::vector<NamedScenario> bundled_scenario_files();

/// Returns the directory tests/data.
std::filesystem::path data_directory();

/// Calls `work` and returns the InputError that it throws. Fails the test and returns nothing if `work` does
/// not throw. Other exceptions are not caught.
template <class Work>
std::optional<InputError> input_error_of(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return std::nullopt;
}

}  // namespace hapbench::test
