#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/format/json_file.hpp"

/// Scenarios to test with.
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

}  // namespace hapbench::test
