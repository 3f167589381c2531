#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"

/// What `hapbench describe` says of the numbers in result files.
namespace hapbench {

struct Description {
  std::string text;
  Json json;
};

/// The metric of that name, the columns of that name, the file of that name with all its columns; "metrics" or
/// "summary.json" for all metrics, "columns" or "columns.json" for all files. Nothing for other names.
std::vector<Description> describe_results(const std::string& name);

/// The names it knows.
std::vector<std::string> result_names();

}  // namespace hapbench
