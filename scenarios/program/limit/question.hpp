#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/program/options.hpp"

/// The question of `limit`: from options to cases, each with what is asked of it.
namespace hapbench {

/// The options of `limit`.
struct LimitOptions : CommonOptions {
  std::vector<std::string> scenarios;
  std::string field = kStiffnessPath;
  std::string between, resolution, stable, vibration;
  std::vector<std::string> bounds;
  bool smallest = false;
  std::vector<std::string> algorithms, devices, friction, over;
};

/// The answer of a case, and what it was: a line of limit.csv.
struct LimitRow {
  FieldLimit limit = {};
  std::vector<std::string> axis_values = {};  ///< of LimitTable::cases
  const ComparedDevice* device = nullptr;     ///< none: the scene's own
  Scenario scenario = {};                     ///< as it is asked for, with its own value of the field
  LimitQuestion asked = {};
  /// The limit over that of the first scene and algorithm, all else equal, and the same of K lambda_max(S), the
  /// stiffness that the hand meets; empty where either has no limit.
  std::optional<double> stiffness_ratio = {}, rendered_ratio = {};

  const std::string& scene() const { return axis_values[axis_values.size() - 2]; }
  const std::string& algorithm() const { return scenario.rendering.algorithm; }
};

/// The cases of a question, and their answers.
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

/// A table without rows. The axis of --device has no field's name, which it leaves to --over. Throws InputError.
LimitTable asked_table(const LimitOptions& options);
/// The case of that number. Warnings that are not among them yet are added.
LimitRow asked_row(const LimitOptions& options, const LimitTable& table, std::size_t i,
                   std::vector<std::string>& warnings);

}  // namespace hapbench
