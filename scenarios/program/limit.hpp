#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/cases/cases.hpp"
#include "scenarios/format/scenario.hpp"
#include "scenarios/limits/stability/field_limit.hpp"
#include "scenarios/limits/stability/scene_devices.hpp"
#include "scenarios/program/report.hpp"

/// What `limit` finds, and options that other searches share.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);
/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);
/// The devices of these names and files, each once; a preset's name with [soft] or [stiff] behind it is the preset at
/// that end of what nobody published of it. Throws InputError.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

/// The answer of a case, and what it was: a line of limit.csv.
struct LimitRow : FieldLimit {
  std::vector<std::string> axis_values = {};  ///< of LimitTable::cases
  const ComparedDevice* device = nullptr;     ///< none: the scene's own
  Scenario scenario = {};                     ///< as it is asked for, with its own value of the field
  LimitQuestion asked = {};
  /// The limit over that of the first scene and algorithm, all else equal, and the same of K lambda_max(S), the
  /// stiffness that the hand meets; empty where either has no limit.
  std::optional<double> stiffness_ratio = {}, rendered_ratio = {};

  /// The name of the scene's file.
  const std::string& scene() const { return axis_values[axis_values.size() - 2]; }
  const std::string& algorithm() const { return scenario.rendering.algorithm; }
};

/// A row for each case.
struct LimitTable {
  std::vector<ComparedDevice> devices;  ///< empty: each scene's own
  /// The axes are the device, the fields of --over, the scene and the algorithm; all but the fields are named.
  Cases cases;
  std::vector<LimitRow> rows = {};

  const LimitRow& first() const { return rows.front(); }
  /// The fields of --over: axes 1 to this one.
  std::size_t over() const { return cases.axes().size() - 3; }
  /// Scenes times algorithms: as many rows follow each other with all else equal.
  std::size_t columns() const { return cases.axes()[over() + 1].size() * cases.axes()[over() + 2].size(); }
  /// True where a table of rows and columns shows the limits, and not one of every number.
  bool is_grid() const { return !devices.empty() || over() > 0; }
};

/// The answer in words: the linear edge, or the edge in runs, and what was tried between.
std::string limit_answer(const FieldLimit& found, double resolution);

/// Writes limit.csv and limit_runs.csv, and tells what was found.
void tell_limits(const LimitTable& table, Report& report);

}  // namespace hapbench
