#pragma once

#include <array>
#include <compare>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

/// A trial of `tune`: a setting with a stiffness K, and whether it is feasible.
namespace hapbench {

/// Metrics that are reported for a choice (the setting that the search selected), in the order of the tables. Users
/// most often limit the first three.
inline constexpr std::array kTuneMetrics = {"inside_max_m",     "force_rms_above_30Hz_N",  "settled_force_step_max_N",
                                            "inside_settled_m", "force_mean_in_contact_N", "landing_force_max_N"};
/// Values by metric name.
using TuneMetrics = std::map<std::string, double, std::less<>>;

/// Returns the value of the metric `name` times a factor; empty if there is no such metric.
std::optional<double> value_in(const TuneMetrics& metrics, std::string_view name, double factor = 1.0);

/// The tuned fields besides K. An empty field keeps the scene's value.
struct TuneSetting {
  std::optional<double> damping_ratio;  ///< zeta
  std::optional<double> mass;           ///< virtual mass [kg]
  std::string filter;                   ///< device.velocity_filter as JSON; empty: the scene's filter

  auto operator<=>(const TuneSetting&) const = default;
};

/// Returns the fields of a setting as text, such as ", zeta = 0.3, 0.2 kg".
std::string setting_text(const TuneSetting& setting);

/// A setting with a stiffness, evaluated for one law. G: the required gain margin.
struct TuneTrial {
  TuneSetting setting = {};
  std::string algorithm = {};
  double stiffness = 0.0;  ///< K [N/m]
  /// Violated constraint; empty if the trial is feasible. "settled": a run at K is not stable by rule_of() (below
  /// called settled). "margin": a run at G K is not. "runs": the maximum number of runs is reached. "range": K is at
  /// the end of the range. Otherwise the name of the metric whose limit is violated.
  std::string binding = {};
  std::string why = {};       ///< reason of the violation, for the user
  bool too_soft = false;      ///< true if a larger K may keep the constraint
  bool settled = false;       ///< true if the run of the scene itself, without variants, is settled at K
  bool limits_alone = false;  ///< true if only limits on metrics are violated
  TuneMetrics metrics = {};   ///< metrics of the run of the scene itself; empty if not measured
  /// Worst value of each limited metric over all variants. If the user gave no limits: the numbers of the
  /// low-vibration rules for the scene itself.
  TuneMetrics worst = {};
  std::map<std::string, std::string> worst_text = {};  ///< the numbers of `worst` as texts for the user
  /// Largest eigenvalue of the mean stiffness tensor S at the end of the scene's run, in units of K.
  double lambda_max = 0.0;

  bool feasible() const { return binding.empty(); }
  /// Returns the largest rendered stiffness [N/m].
  double rendered() const { return stiffness * lambda_max; }
  /// Marks the trial as infeasible.
  void fail(std::string constraint, std::string reason);
};

}  // namespace hapbench
