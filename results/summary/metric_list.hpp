#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "results/observe/energy_ledger.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/lost_torque.hpp"
#include "results/observe/metrics.hpp"
#include "results/observe/passivity_observer.hpp"
#include "results/observe/perception.hpp"
#include "results/observe/target_metrics.hpp"

namespace hapbench {

/// A number of a run, by name. It has no value when it does not exist (a ratio without contact) or is not finite.
struct Metric {
  using Value = std::variant<std::monostate, std::uint64_t, double>;  ///< none, a count, a number

  std::string name;  ///< dots lead into sections, as in "gentle.rows"
  const char* unit = "";
  const char* meaning = "";  ///< what it says and how it is computed; ||.|| is the Euclidean norm, f is f_render
  Value value = {};
};

using MetricList = std::vector<Metric>;

/// The lists from which summary.json, expectations and the tables of sweeps take names and values, in one order. The
/// names do not depend on the run, except that each target place has its own.
MetricList metric_list(const Metrics& metrics);
/// The coordinates of the final position.
MetricList final_position_list(const Metrics& metrics);
MetricList metric_list(const std::optional<PassivityMetrics>& passivity);
MetricList metric_list(const EnergyMetrics& energy);
MetricList metric_list(const IdealTrajectoryMetrics& ideal_trajectory);
MetricList metric_list(const ForceFidelity& fidelity);
MetricList metric_list(const LostTorqueMetrics& torque);
MetricList metric_list(const PerceptionMetrics& perception);
MetricList metric_list(const std::vector<PlaceMetrics>& targets);

/// The value of that name; none when there is no such metric.
Metric::Value value_of(const MetricList& list, std::string_view name);
/// A value as a number.
std::optional<double> number_of(const Metric::Value& value);
/// A value as a cell of a CSV file; empty for none.
std::string cell_text(const Metric::Value& value);

/// Appends `more`, its names in the section, if one is given.
void append(MetricList& list, std::string_view section, const MetricList& more);

}  // namespace hapbench
