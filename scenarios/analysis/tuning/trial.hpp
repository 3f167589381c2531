#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "algorithms/rendering_config.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/convergence/metric_errors.hpp"

/// A trial of `tune`: a setting with a stiffness K, and whether it is feasible.
namespace hapbench {

/// Metrics that are reported for a choice (the setting that the search selected), in the order of the result tables.
/// Users most often limit the first three metrics.
inline constexpr std::array kTuneMetrics = {"inside_max_m",     "force_rms_above_30Hz_N",  "settled_force_step_max_N",
                                            "inside_settled_m", "force_mean_in_contact_N", "landing_force_max_N"};
/// Returns the value of the metric `name` times a factor; empty if there is no such metric.
std::optional<double> value_in(const MetricValues& metrics, std::string_view name, double factor = 1.0);

/// The tuned fields besides K. An empty field keeps the scene's value.
struct TuneSetting {
  std::optional<double> damping_ratio;  ///< zeta
  std::optional<double> mass;           ///< virtual mass [kg]
  std::string filter;                   ///< device.velocity_filter as JSON; empty: the scene's filter

  auto operator<=>(const TuneSetting&) const = default;
};

/// Returns the fields of a setting as text, such as ", zeta = 0.3, 0.2 kg".
std::string setting_text(const TuneSetting& setting);

/// A failure of a trial other than a violated limit on metrics: a run or a linear loop that is not stable, or a force
/// that is zero.
struct TuneFailure {
  std::string binding;  ///< the violated constraint, as in TuneTrial::binding
  std::string why;      ///< the reason for the user, as in TuneTrial::why
  /// Name of the variant; empty for the scene itself.
  std::string variant = {};
  std::string family = {};  ///< variant set that contains the variant (kFamilies); empty for the scene itself
  /// Name of the verdict on the run, such as "no_contact"; empty if the linear loop is unstable.
  std::string verdict = {};
  bool too_soft = false;          ///< true if a larger K may help
  bool unstable_at_K = false;     ///< true if the linear loop is unstable at K itself, and not only above K
  std::size_t variant_index = 0;  ///< index of the variant; 0: the scene itself
};

/// The contact of a run, linearised at the equilibrium of the tool. `linear` is empty if the contact did not last until
/// the end of the run, if no equilibrium was found, or if the scene has no linear loop. It is also empty if the scene
/// renders springs in permanent contact: TrialRuns then uses their stiffness tensor instead
/// (TrialRuns::loops_in_contact).
struct ContactOfTrial {
  std::optional<LinearContact> linear = {};
  RenderingConfig rendering = {};  ///< rendering settings with which `linear` was computed
};

/// The largest or the smallest value of a metric over the evaluated variants.
struct ExtremeValue {
  double value;
  std::string text;  ///< the value for the user, with the name of the variant that has it
};

/// One end of the range that a limit allows for a metric.
struct LimitEnd {
  std::string metric;
  bool is_max;  ///< true: the maximum; false: the minimum
};

/// A setting with a stiffness, evaluated for one law. G: the required gain margin.
struct TuneTrial {
  TuneSetting setting = {};
  std::string algorithm = {};
  double stiffness = 0.0;  ///< K [N/m]
  /// Violated constraint; empty if the trial is feasible. "settled": not settled at K. "margin": not settled at G K.
  /// "no_force": no force is rendered. "friction": explicit integration of friction is unstable in the run. "runs": the
  /// maximum number of runs is reached. "range": K would be above the upper end of the searched range. Otherwise the
  /// name of the metric whose limit is violated, or of the rule of the diagnosis that applies (RuleKind).
  std::string binding = {};
  std::string why = {};       ///< reason of the violation, for the user
  bool too_soft = false;      ///< true if a larger K may keep the constraint
  bool settled = false;       ///< true if the run of the scene itself is settled at K
  bool limits_alone = false;  ///< true if only limits on metrics are violated, as far as the trial was evaluated
  MetricValues metrics = {};  ///< metrics of the run of the scene itself; empty if not measured
  /// Largest value of each limited metric over the evaluated variants, and the low-vibration numbers of the scene
  /// itself.
  std::map<std::string, ExtremeValue> largest = {};
  std::map<std::string, ExtremeValue> smallest = {};  ///< smallest value of each limited metric
  /// Text for the user about each limited metric that has no value in one of the variants. Such a metric has no largest
  /// and no smallest value.
  std::map<std::string, std::string> missing = {};
  /// Error estimate of each metric in `metrics`: its largest change by the refinements that were made so far. Empty if
  /// no refinement was made, for example because the metrics exceed their limits by far.
  MetricValues error = {};

  // How far the trial was evaluated. Trials evaluates a trial only as far as a caller needs it (Need).
  std::size_t judged = 0;     ///< number of variants whose motion was judged, the scene itself first
  bool is_measured = false;   ///< true if metrics were measured in the run of the scene itself
  bool is_complete = false;   ///< true if limited metrics were measured in all variants
  bool is_refined = false;    ///< true if `error` has the changes by Refinement::resolution
  bool has_error = false;     ///< true if `error` has the changes by all refinements
  double depth_within = 0.0;  ///< largest possible change of inside_max_m by Refinement::depth [m]
  std::size_t runs = 0;       ///< number of simulations of the trial
  /// The variant whose motion fails and how it fails; empty if no motion fails. The failure does not depend on limits.
  std::optional<TuneFailure> failure = {};
  /// Largest eigenvalue of the mean stiffness tensor S at the end of the scene's run, in units of K.
  double lambda_max = 0.0;
  ContactOfTrial contact = {};  ///< contact at the end of the scene's run at K

  bool feasible() const { return binding.empty(); }
  /// Returns the largest rendered stiffness [N/m].
  double rendered() const { return stiffness * lambda_max; }
  /// Returns the largest value (for a maximum) or the smallest value (for a minimum) of a limited metric; null if the
  /// metric has no value.
  const ExtremeValue* extreme(const LimitEnd& end) const;
  /// Returns the strictest value of a limit that the trial keeps: the extreme() value of the metric with its error
  /// added to a maximum, or subtracted from a minimum. Empty if the metric has no value.
  std::optional<double> kept(const LimitEnd& end) const;
  /// Marks the trial as infeasible.
  void fail(std::string constraint, std::string reason);
};

}  // namespace hapbench
