#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

/// Scenarios to test with, and what is said of wrong ones.
namespace hapbench::test {

struct NamedScenario {
  std::string name;
  Json json;
};

/// Only what must be there: time, and the environment of each type.
std::vector<NamedScenario> minimal_scenarios();
/// The minimal scenario of one environment type.
Json minimal_scenario(const std::string& environment_type);

/// Scenarios that between them give every field of the schema a value, in valid ways that the bundled ones do not use.
/// They name the files cube.obj, shell.csv, stroke.csv and trace.csv, which tests/data holds.
std::vector<NamedScenario> rich_scenarios();

/// Every scenario that comes with the program, with what it extends filled in.
std::vector<NamedScenario> bundled_scenario_files();

/// tests/data
std::filesystem::path data_directory();

/// The InputError that `work` throws; none, and a failed test, when it throws nothing. Other exceptions go through.
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
