#pragma once

#include <array>
#include <compare>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

/// A trial of `tune`: a setting at a stiffness, and its judgement.
namespace hapbench {

/// The metrics of a choice, in the order of tables; users most often limit the first three.
inline constexpr std::array kTuneMetrics = {"inside_max_m",     "force_rms_above_30Hz_N",  "settled_force_step_max_N",
                                            "inside_settled_m", "force_mean_in_contact_N", "landing_force_max_N"};
using TuneMetrics = std::map<std::string, double, std::less<>>;

/// Returns the value of that name times a factor; empty if there is none.
std::optional<double> value_in(const TuneMetrics& metrics, std::string_view name, double factor = 1.0);

/// The fields that are chosen besides K; fields that are not searched keep the scene's value.
struct TuneSetting {
  std::optional<double> damping_ratio, mass;
  std::string filter;  ///< device.velocity_filter as JSON; empty: the scene's

  auto operator<=>(const TuneSetting&) const = default;
};

/// Returns what a setting chooses, such as ", zeta = 0.3, 0.2 kg".
std::string setting_text(const TuneSetting& setting);

/// A setting and K, tried for a law.
struct TuneTrial {
  TuneSetting setting = {};
  std::string algorithm = {};
  double stiffness = 0.0;  ///< K [N/m]
  /// The constraint that is violated: "settled" (at K), "margin" (at G K), "runs" (their largest number), "range" (the
  /// end of the search) or a limited metric; empty if all constraints are kept.
  std::string binding = {};
  std::string why = {};       ///< the same in words
  bool too_soft = false;      ///< a larger K may keep the constraint
  bool settled = false;       ///< the scene's own run is settled at K
  bool limits_alone = false;  ///< settled with the margin in all runs: only limits on metrics are violated
  TuneMetrics metrics = {};   ///< of the scene's own run; empty if they were not measured
  /// Worst value of each limited metric over the runs of the family; if only the own run has to have low vibration, its
  /// numbers.
  TuneMetrics worst = {};
  std::map<std::string, std::string> worst_text = {};  ///< the same in words
  double lambda_max = 0.0;  ///< largest eigenvalue of the mean S at the end of the own run: K lambda_max is rendered

  bool feasible() const { return binding.empty(); }
  /// Returns the rendered stiffness that the hand meets [N/m].
  double rendered() const { return stiffness * lambda_max; }
  void fail(std::string constraint, std::string reason);
};

}  // namespace hapbench
