#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/program/options.hpp"

/// Turns the options of `limit` into cases, each with the question for its stability limit.
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

/// A case with its question and answer: a row of limit.csv.
struct LimitRow {
  FieldLimit limit = {};
  std::vector<std::string> axis_values = {};  ///< value of each axis of LimitTable::cases
  const ComparedDevice* device = nullptr;     ///< null: the scene's device
  /// The scenario with overrides, device and axis values. The searched field has the value that the scenario gives it.
  Scenario scenario = {};
  LimitQuestion question = {};
  /// stiffness_ratio: the limit divided by the limit of the reference case. The reference case has the first scene, the
  /// first algorithm, and the same values of all other axes. rendered_ratio: the same ratio of the rendered stiffness K
  /// lambda_max(S), with the stiffness tensor S in units of K. Empty if one of the two cases has no limit.
  std::optional<double> stiffness_ratio = {}, rendered_ratio = {};

  const std::string& scene() const { return axis_values[axis_values.size() - 2]; }
  const std::string& algorithm() const { return scenario.rendering.algorithm; }
};

/// The cases of a command line, and their answers.
struct LimitTable {
  std::vector<ComparedDevice> devices;  ///< empty: each scene's device
  /// The axes are, in this order: the device, each field of --over, the scene and the algorithm.
  Cases cases;
  std::vector<LimitRow> rows = {};

  const LimitRow& first() const { return rows.front(); }
  /// Number of fields of --over. These fields are the axes 1 to over().
  std::size_t over() const { return cases.axes().size() - 3; }
  /// Number of scenes times number of algorithms. The rows of each block of columns() successive rows differ only in
  /// scene and algorithm.
  std::size_t columns() const { return cases.axes()[over() + 1].size() * cases.axes()[over() + 2].size(); }
  /// True if the limits are printed as a grid, with a row for each device or value of --over. Otherwise there are few
  /// limits, and each is printed with all its numbers.
  bool is_grid() const { return !devices.empty() || over() > 0; }
};

/// Returns a table with all cases but without rows. The device axis replaces the whole device and has no path of a
/// field, so that --over may vary fields of the device. Throws InputError for an invalid option or scenario file.
LimitTable make_limit_table(const LimitOptions& options);
/// Returns the row of case i, in which LimitRow::limit is still empty. Adds the warnings about this case to `warnings`,
/// each text once. Throws InputError if the scenario of the case or an option is invalid.
LimitRow make_limit_row(const LimitOptions& options, const LimitTable& table, std::size_t i,
                        std::vector<std::string>& warnings);

}  // namespace hapbench
