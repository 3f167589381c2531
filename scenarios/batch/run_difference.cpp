#include "scenarios/batch/run_difference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A column that both tables have.
struct SharedColumn {
  std::size_t in_a = 0, in_b = 0;
  double magnitude = 0.0;  ///< largest so far
  ColumnDifference difference = {};
  bool differs = false;
};

std::optional<std::size_t> place_of(std::string_view name, const Words& columns) {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - columns.begin()));
}

std::vector<SharedColumn> shared_columns(const Words& a, const Words& b, TableDifference& difference) {
  std::vector<SharedColumn> shared;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto other = place_of(a[i], b);
    if (!other) {
      difference.only_in_a.emplace_back(a[i]);
      continue;
    }
    shared.push_back({i, *other});
    shared.back().difference.column = a[i];
  }
  for (const std::string_view name : b)
    if (!place_of(name, a)) difference.only_in_b.emplace_back(name);
  difference.reordered = !std::is_sorted(shared.begin(), shared.end(),
                                         [](const SharedColumn& x, const SharedColumn& y) { return x.in_b < y.in_b; });
  return shared;
}

void compare_cells(std::string_view a, std::string_view b, std::size_t row, SharedColumn& column,
                   TableDifference& difference) {
  const auto number_a = finite_number(a), number_b = finite_number(b);
  for (const auto& number : {number_a, number_b})
    if (number) column.magnitude = std::max(column.magnitude, std::abs(*number));
  if (a == b) return;
  if (!difference.first) difference.first = {row, column.difference.column, std::string(a), std::string(b)};
  const double size = number_a && number_b ? std::abs(*number_a - *number_b) : kInfinity;
  if (!column.differs || size > column.difference.largest) {
    column.difference.largest = size;
    column.difference.row = row;
  }
  column.differs = true;
}

/// Names and values of a file, in the order of the file.
using Values = std::vector<std::pair<std::string, std::string>>;

/// Fields of summary.json that are not results of the run, or are compared separately.
constexpr std::string_view kNoResults[] = {"name", "algorithm",  "expected",  "warnings",
                                           "work", "provenance", "state_hash"};

void flatten(const Json& json, const std::string& name, Values& values) {
  if (json.is_structured() && !json.empty())
    for (const auto& [key, value] : json.items()) flatten(value, name.empty() ? key : name + "." + key, values);
  else
    values.emplace_back(name, json.is_null() ? "" : json.is_string() ? json.get<std::string>() : json.dump());
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

/// Metrics have no section in front of their names, as in `expect` and --by.
Values results_of(const Json& summary) {
  Values values;
  for (const auto& [key, value] : summary.items()) {
    if (std::find(std::begin(kNoResults), std::end(kNoResults), key) != std::end(kNoResults)) continue;
    flatten(value, key == "metrics" ? "" : key, values);
  }
  return values;
}

/// Calls `visit` for each name with its values in both; null where it is missing.
template <class Visit>
void for_each_pair(const Values& a, const Values& b, Visit visit) {
  const auto value_of = [](const Values& values, const std::string& name) {
    const auto found = std::find_if(values.begin(), values.end(), [&name](const auto& v) { return v.first == name; });
    return found == values.end() ? nullptr : &found->second;
  };
  for (const auto& [name, value] : a) visit(name, &value, value_of(b, name));
  for (const auto& [name, value] : b)
    if (value_of(a, name) == nullptr) visit(name, nullptr, &value);
}

std::string state_hash_of(const Json& summary) {
  const auto hash = summary.find("state_hash");
  return hash != summary.end() && hash->is_string() ? hash->get<std::string>() : "";
}

std::set<std::string> warnings_of(const Json& summary) {
  std::set<std::string> texts;
  for (const Json& warning : summary.value("warnings", Json::array()))
    texts.insert(warning.is_string() ? warning.get<std::string>() : warning.dump());
  return texts;
}

/// Compares contents, because paths in a scenario are relative to its folder and differ for one file.
bool are_the_same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  try {
    return read_named_file(a) == read_named_file(b);
  } catch (const InputError&) {
    return false;
  }
}

Values fields_of(const fs::path& run) {
  Json scenario = read_object(run / "scenario.effective.json");
  scenario.erase("expect");  // expectations do not change the run
  Values values;
  flatten(scenario, "", values);
  return values;
}

std::vector<NamedDifference> compare_fields(const fs::path& a, const fs::path& b) {
  std::vector<NamedDifference> fields;
  for_each_pair(fields_of(a), fields_of(b),
                [&](const std::string& name, const std::string* in_a, const std::string* in_b) {
                  if (in_a != nullptr && in_b != nullptr) {
                    if (*in_a == *in_b || (name.ends_with(".file") && are_the_same_file(a / *in_a, b / *in_b))) return;
                  }
                  fields.push_back({name, cell_difference(in_a == nullptr ? "" : *in_a, in_b == nullptr ? "" : *in_b)});
                });
  return fields;
}

void compare_results(const Json& a, const Json& b, RunDifference& difference) {
  for_each_pair(results_of(a), results_of(b),
                [&](const std::string& name, const std::string* in_a, const std::string* in_b) {
                  if (in_a == nullptr || in_b == nullptr)
                    difference.unshared.push_back((in_b == nullptr ? "< " : "> ") + name);
                  else if (*in_a != *in_b)
                    difference.metrics.push_back({name, cell_difference(*in_a, *in_b)});
                });
  const std::set<std::string> warnings_a = warnings_of(a), warnings_b = warnings_of(b);
  for (const std::string& text : warnings_a)
    if (!warnings_b.contains(text)) difference.unshared.push_back("< warning: " + text);
  for (const std::string& text : warnings_b)
    if (!warnings_a.contains(text)) difference.unshared.push_back("> warning: " + text);
  difference.state_hash_a = state_hash_of(a);
  difference.state_hash_b = state_hash_of(b);
}

}  // namespace

CellDifference cell_difference(std::string a, std::string b) {
  const auto number_a = finite_number(a), number_b = finite_number(b);
  CellDifference difference{std::move(a), std::move(b), kInfinity, kInfinity};
  if (!number_a || !number_b) return difference;
  difference.largest = std::abs(*number_a - *number_b);
  const double magnitude = std::max(std::abs(*number_a), std::abs(*number_b));
  difference.relative = magnitude > 0.0 ? difference.largest / magnitude : 0.0;
  return difference;
}

bool TableDifference::is_beyond(double tolerance) const {
  if (rows_a != rows_b || !only_in_a.empty() || !only_in_b.empty() || reordered) return true;
  if (tolerance == 0.0) return !columns.empty();
  return std::any_of(columns.begin(), columns.end(), [tolerance](const ColumnDifference& column) {
    return column.column != "state_hash" && !(column.relative <= tolerance);
  });
}

TableDifference compare_tables(const fs::path& a, const fs::path& b) {
  const std::string text_a = read_named_file(a), text_b = read_named_file(b);
  CsvReader rows_a{LineReader(text_a), a}, rows_b{LineReader(text_b), b};
  TableDifference difference;
  std::vector<SharedColumn> columns = shared_columns(rows_a.columns(), rows_b.columns(), difference);
  bool more_a = rows_a.next(), more_b = rows_b.next();
  for (; more_a && more_b; more_a = rows_a.next(), more_b = rows_b.next()) {
    const std::size_t row = difference.rows_a;
    for (SharedColumn& column : columns)
      compare_cells(rows_a.cells()[column.in_a], rows_b.cells()[column.in_b], row, column, difference);
    ++difference.rows_a;
    ++difference.rows_b;
  }
  for (; more_a; more_a = rows_a.next()) ++difference.rows_a;
  for (; more_b; more_b = rows_b.next()) ++difference.rows_b;
  for (SharedColumn& column : columns) {
    if (!column.differs) continue;
    ColumnDifference& d = column.difference;
    d.relative = column.magnitude > 0.0 || std::isinf(d.largest) ? d.largest / column.magnitude : 0.0;
    difference.columns.push_back(d);
  }
  return difference;
}

bool RunDifference::is_beyond(double tolerance) const {
  if (trajectory_missing || !unshared.empty() || (trajectory && trajectory->is_beyond(tolerance))) return true;
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
