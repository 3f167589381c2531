#include "scenarios/batch/run_difference.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/number_table.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Names and values of a file in its order.
using Values = std::vector<std::pair<std::string, std::string>>;

/// What in summary.json is no result of the run, or is compared on its own.
constexpr std::string_view kNoResults[] = {"name", "algorithm",  "expected",  "warnings",
                                           "work", "provenance", "state_hash"};

void flatten(const Json& json, const std::string& name, Values& values) {
  if (json.is_structured() && !json.empty()) {
    for (const auto& [key, value] : json.items()) flatten(value, name.empty() ? key : name + "." + key, values);
  } else {
    values.emplace_back(name, json.is_null() ? "" : json.is_string() ? json.get<std::string>() : json.dump());
  }
}

Json read_object(const fs::path& file) {
  try {
    Json json = parse_json(read_text_file(file, kLargestJsonFile));
    if (!json.is_object()) throw InputError("is not what a run writes; allowed: a JSON object");
    return json;
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

/// The metrics have no section in front of their names, as in `expect` and --by.
Values results_of(const Json& summary) {
  Values values;
  for (const auto& [key, value] : summary.items()) {
    if (std::find(std::begin(kNoResults), std::end(kNoResults), key) != std::end(kNoResults)) continue;
    flatten(value, key == "metrics" ? "" : key, values);
  }
  return values;
}

const std::string* value_of(const Values& values, const std::string& name) {
  const auto found = std::find_if(values.begin(), values.end(), [&name](const auto& v) { return v.first == name; });
  return found == values.end() ? nullptr : &found->second;
}

std::string state_hash_of(const Json& summary) {
  const auto hash = summary.find("state_hash");
  return hash != summary.end() && hash->is_string() ? hash->get<std::string>() : "";
}

/// Paths in scenarios start from their folder, so the same file has other words in another one.
bool are_the_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  try {
    return read_named_file(a) == read_named_file(b);
  } catch (const InputError&) {
    return false;
  }
}

std::vector<NamedDifference> compare_fields(const fs::path& a, const fs::path& b) {
  const char* file = "scenario.effective.json";
  Values values_a, values_b;
  const auto scenario_in = [file](const fs::path& run) {
    Json scenario = read_object(run / file);
    scenario.erase("expect");  // what a run is judged by changes nothing in it
    return scenario;
  };
  flatten(scenario_in(a), "", values_a);
  flatten(scenario_in(b), "", values_b);
  std::vector<NamedDifference> fields;
  for (const auto& [name, value] : values_a) {
    const std::string* other = value_of(values_b, name);
    if (other != nullptr && *other == value) continue;
    if (other != nullptr && name.ends_with(".file") && are_the_same_file(a / value, b / *other)) continue;
    fields.push_back({name, cell_difference(value, other == nullptr ? "" : *other)});
  }
  for (const auto& [name, value] : values_b) {
    if (value_of(values_a, name) == nullptr) fields.push_back({name, cell_difference("", value)});
  }
  return fields;
}

void compare_results(const Json& a, const Json& b, RunDifference& difference) {
  const Values values_a = results_of(a), values_b = results_of(b);
  for (const auto& [name, value] : values_a) {
    const std::string* other = value_of(values_b, name);
    if (other == nullptr) {
      difference.unshared.push_back("< " + name);
    } else if (*other != value) {
      difference.metrics.push_back({name, cell_difference(value, *other)});
    }
  }
  for (const auto& [name, value] : values_b) {
    if (value_of(values_a, name) == nullptr) difference.unshared.push_back("> " + name);
  }
  difference.state_hash_a = state_hash_of(a);
  difference.state_hash_b = state_hash_of(b);
}

}  // namespace

bool RunDifference::is_beyond(double tolerance) const {
  if (trajectory_missing || (trajectory && trajectory->is_beyond(tolerance))) return true;
  if (tolerance == 0.0) return !metrics.empty() || state_hash_a != state_hash_b;
  return std::any_of(metrics.begin(), metrics.end(),
                     [tolerance](const NamedDifference& metric) { return !(metric.values.relative <= tolerance); });
}

RunDifference compare_runs(const fs::path& a, const fs::path& b) {
  RunDifference difference;
  difference.fields = compare_fields(a, b);
  compare_results(read_object(a / "summary.json"), read_object(b / "summary.json"), difference);
  const fs::path trajectory_a = a / "trajectory.csv", trajectory_b = b / "trajectory.csv";
  std::error_code ignored;
  const bool has_a = fs::exists(trajectory_a, ignored), has_b = fs::exists(trajectory_b, ignored);
  if (has_a && has_b) difference.trajectory = compare_tables(trajectory_a, trajectory_b);
  difference.trajectory_missing = has_a != has_b;
  return difference;
}

}  // namespace hapbench
