#pragma once

#include <array>

#include "scenarios/analysis/stability/field_limit.hpp"

/// Which stiffness and damping to use: for a force law in a scene the largest K, over damping ratio, velocity filter
/// and virtual mass, at which the worst run of a family is settled with a gain margin and keeps limits on its metrics.
namespace hapbench {

/// The metrics of a choice, in the order of tables; the first three are those that one bounds most.
inline constexpr std::array kTuneMetrics = {"inside_max_m",     "force_rms_above_30Hz_N",  "settled_force_step_max_N",
                                            "inside_settled_m", "force_mean_in_contact_N", "landing_force_max_N"};
using TuneMetrics = std::map<std::string, double, std::less<>>;
/// The value of that name times a factor, if there is one.
inline std::optional<double> value_in(const TuneMetrics& metrics, std::string_view name, double factor = 1.0) {
  const auto found = metrics.find(name);
  return found == metrics.end() ? std::nullopt : std::optional(factor * found->second);
}

/// The families of runs besides the scene's own that a setting has to hold in:
///   hands   that are springs with the scene's damping: the ends of hand_family(), 100 and 1000 N/m, on an impedance
///           device's handle with 0.1 and 0.5 kg each
///   seeds   four further seeds, started 10 um away: less than a hand repeats a place
///   speeds  the script of hand and tool at half and twice its speed
inline constexpr const char* kFamilies[] = {"hands", "seeds", "speeds"};

struct FamilyMember {
  std::string name;                         ///< for people, as in "a hand of 0.5 kg and 1000 N/m"
  std::vector<std::string> overrides = {};  ///< none: the scene's own run
};
/// Empty where the scene has nothing to vary, as a hand whose force is a script.
std::vector<FamilyMember> family_of(const LoadedScenario& loaded, const std::string& family);

struct TuneQuestion {
  ScenarioText scenario;
  std::vector<std::string> overrides;
  double margin = 2.0;  ///< G: settled up to G K
  /// On metrics of every run at K; without any, the own run has to be quiet by the rules of the diagnosis.
  std::map<std::string, MetricBound> limits = {};
  std::vector<std::string> families = {"hands"};  ///< their runs together
  Range damping_ratio = {0.01, 10.0, true};       ///< zeta; of an impedance device by the mass of its handle
  std::optional<Range> mass = {};  ///< of the virtual mass on an admittance device [kg]; none: half to twice the own
  bool filters = false;            ///< also try velocity filters of an impedance device
  unsigned threads = 1;
  std::function<void(std::size_t runs)> on_runs = {};  ///< hears how many runs were made, now and then
};

/// The fields that are chosen besides K; what is not searched keeps the scene's value.
struct TuneSetting {
  std::optional<double> damping_ratio, mass;
  std::string filter;  ///< device.velocity_filter as JSON; empty: the scene's

  auto operator<=>(const TuneSetting&) const = default;
};

/// ", zeta = 0.3, 0.2 kg", of what is chosen.
inline std::string setting_text(const TuneSetting& setting) {
  std::string text;
  if (setting.damping_ratio) text += fmt::format(", zeta = {:.3g}", *setting.damping_ratio);
  if (setting.mass) text += fmt::format(", {:.3g} kg", *setting.mass);
  return setting.filter.empty() ? text : text + ", " + setting.filter;
}

/// A setting and K, tried for a law.
struct TuneTrial : TuneSetting {
  std::string algorithm = {};
  double stiffness = 0.0;
  /// The constraint that is not kept: "settled" (at K), "margin" (at G K), "runs" (the bound on them), "range" (the end
  /// of the search) or the limited metric; empty where all are.
  std::string binding;
  std::string why;            ///< the same in words
  bool too_soft = false;      ///< a stiffer one may keep it
  bool settled = false;       ///< the own run is, at K
  bool limits_alone = false;  ///< settled with the margin in all runs: only limits are not kept
  TuneMetrics metrics;        ///< of the scene's own run; empty where they were not asked for
  TuneMetrics worst;          ///< of what is limited, the worst of the family's runs; of a quiet run its numbers
  std::map<std::string, std::string> worst_text = {};  ///< the same in words
  double lambda_max = 0.0;  ///< largest eigenvalue of the mean S in the end of the own run: K lambda_max is rendered

  bool feasible() const { return binding.empty(); }
  double rendered() const { return stiffness * lambda_max; }  ///< the stiffness that the hand meets [N/m]
  void fail(std::string constraint, std::string reason) {
    binding = std::move(constraint);
    why = std::move(reason);
  }
};

/// What a choice can bear before the worst run of the family is not settled any more, at most kMostGain and kMostDelay;
/// empty where it cannot be asked, as of the delay of an ideal device.
struct TuneMargins {
  std::optional<double> gain;           ///< factor on K
  std::optional<double> delay_samples;  ///< more delay of the device's force, or of an admittance device's servo
  std::optional<double> damping_ratio;  ///< of the least damped mode of the loop in contact
};
inline constexpr double kMostGain = 64.0, kMostDelay = 64.0;

/// The answer for one law.
struct TunedLaw {
  std::string algorithm;
  std::optional<TuneTrial> choice;  ///< none: nothing is feasible
  /// Of the stiffness just beyond the choice, or where nothing is feasible what was nearest: the constraint.
  std::string binding, why;
  std::string relax;  ///< where nothing is feasible: which limit to relax, and by how much
  TuneMargins margins;
  FieldLimit edge;  ///< of K in the scene as chosen, with its own hand: what `limit` finds
  /// How far at most half the step, half the distance of the points and a look at the depth in every row move the
  /// metrics of the own run; none of a metric that such a run does not have.
  TuneMetrics error;
  std::vector<TuneTrial> trials;       ///< all, by setting and K; those along K at the choice's setting among them
  std::size_t runs = 0;                ///< simulations in all
  std::size_t verified = 0;            ///< full-length ones between K and G K, all settled (kTriedBetween, kTriedNear)
  std::vector<std::string> overrides;  ///< that make the scene the choice
};

/// Search of a law ends at so many simulations; margins, errors and verification take a few hundred more.
inline constexpr std::size_t kMostTuneRuns = 6000;

/// The ranges that are searched, of zeta and the virtual mass where they have a part.
struct TuneRanges {
  Range stiffness;
  std::optional<Range> damping_ratio, mass;
};
TuneRanges tune_ranges(const TuneQuestion& question, const std::string& algorithm);

/// Tunes one law. The number of threads changes nothing.
///
/// A setting at K is feasible when, for the scene's own run and each of the family, the run at K is settled (rule_of)
/// and keeps the limits (without limits of a user, the own run is quiet: quiet_numbers in diagnosis.hpp), the run at
/// G K is settled, and the loop in contact (contact_loops, with hand_family() on an impedance device that a hand holds)
/// has stable eigenvalues up to G K. Values of zeta in ratios of 10^(1/4) are tried; where K can be raised by half a
/// percent, it is, to its first edge. Where only limits are in the way, the search walks from the trial nearest to them
/// towards them. Then filters are tried with the best mass, and zeta and mass refined until a change by 0.4 % raises K
/// no more. The choice has to be settled at 56 gains from 1 to G, the family taking turns, up to the edge that `limit`
/// finds for the own run, and in runs twice as long unless a script leads on; and it has to keep limits of a user by as
/// much as its metrics are known (TunedLaw::error). Otherwise the search goes on below it. Throws InputError for a
/// scene without a free position, and Stopped.
TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm);

}  // namespace hapbench
