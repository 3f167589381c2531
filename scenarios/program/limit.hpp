#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/cases.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/studies/stability/field_limit.hpp"
#include "scenarios/studies/stability/scene_devices.hpp"

/// What `limit` finds, and options that other searches take, too.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);
/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);
/// The devices of these names and files, each once; a preset's name with [soft] or [stiff] behind it is the preset at
/// that end of what nobody published of it. Throws InputError.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

/// A case of the question and, once it is found, its answer: a line of limit.csv.
struct LimitRow {
  std::optional<ComparedDevice> device = {};  ///< none: the scene's own
  std::vector<std::string> values = {};       ///< of the fields that vary besides
  std::string scene = {};                     ///< the name of its file
  Scenario scenario = {};                     ///< as it is asked for, with its own value of the field
  LimitCase asked = {};
  FieldLimit found = {};
  /// The limit over that of the first scene and algorithm, all else equal, and the same of K lambda_max(S), the
  /// stiffness that the hand meets; none where either has no limit.
  std::optional<double> stiffness_ratio = {}, rendered_ratio = {};
};

/// The devices, on each of them all values of --over, for each of these all scenes with all algorithms.
struct LimitTable {
  std::vector<ScenarioText> scenes = {};
  bool has_devices = false;
  std::vector<std::string> over = {};  ///< paths of the fields that vary besides
  std::vector<LimitRow> rows = {};
  std::size_t columns = 1;  ///< scenes times algorithms: as many rows follow each other with all else equal

  const LimitRow& first() const { return rows.front(); }
  /// True where a table of rows and columns shows the limits, and not one of every number.
  bool is_grid() const { return has_devices || !over.empty(); }
};

/// Writes limit.csv and limit_runs.csv, and tells what was found.
void tell_limits(const LimitTable& table, Report& report);

}  // namespace hapbench
