#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/analysis/tuning/scene_variants.hpp"
#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// The trials of one law: settings with stiffnesses, each evaluated in every variant of the scene.
namespace hapbench {

inline constexpr double kTuneResolution = 5e-3;  ///< relative width at which a search for K stops

/// A run that violates the constraint "settled": it is not stable by rule_of().
struct Failing {
  std::size_t run;  ///< index of the run, from 0
  std::string why;  ///< reason, for the user
};

/// Evaluates and stores all trials of one law.
///
/// Invariants:
/// - each setting and stiffness is run once, when it is first requested;
/// - the result of every trial agrees with the current limits: tighten_limits() re-evaluates all trials;
/// - cap(), the largest K of the search, only decreases: a K that failed a verification is not chosen again;
/// - runs() counts every simulation.
class Trials {
 public:
  /// `question` and `algorithm` must outlive this.
  Trials(const TuneQuestion& question, const std::string& algorithm);

  // ---- The question

  const TuneQuestion& question() const { return question_; }
  const TuneRanges& ranges() const { return ranges_; }
  /// Returns the number of variants, including the scene itself. A trial makes this number of runs at K.
  std::size_t variant_count() const { return variants_.size(); }
  /// Returns true if the variants have other hands.
  bool over_hands() const { return over_hands_; }
  /// Returns true if the user gave no limits. Then the run of the scene itself must have low vibration.
  bool requires_low_vibration() const { return requires_low_vibration_; }
  /// Returns the overrides that apply a setting and K [N/m] to the scene.
  std::vector<std::string> overrides(const TuneSetting& setting, double stiffness) const;
  /// Loads the scene with a setting and K [N/m].
  LoadedScenario load(const TuneSetting& setting, double stiffness) const;

  // ---- Trials

  /// Returns the trial of a setting at K [N/m]. Runs it first if necessary.
  const TuneTrial& trial_at(const TuneSetting& setting, double stiffness);
  /// Returns the trial of a setting at K [N/m], like trial_at(). For K above cap(), returns end() without a run.
  const TuneTrial& beyond(const TuneSetting& setting, double K);
  /// Returns true if a setting is feasible at K [N/m].
  bool feasible(const TuneSetting& setting, double K) { return beyond(setting, K).feasible(); }
  /// Evaluates a trial, and measures its metrics if the run of the scene itself is settled.
  void evaluate_and_measure(const TuneSetting& setting, double stiffness);
  /// Fills TuneTrial::metrics by a run of the scene itself, unless they are filled.
  void measure(TuneTrial& trial);
  /// Returns all trials so far, by setting and K.
  const std::map<std::pair<TuneSetting, double>, TuneTrial>& all() const { return all_; }
  /// Returns the largest eigenvalue of the stiffness tensor in contact, in units of K.
  double lambda_of(const TuneTrial& trial) const { return springs_lambda_.value_or(trial.lambda_max); }
  /// Makes `count` runs of a trial that cycle through the variants. `more`: additional override of a run, such as a
  /// larger K. Returns the first run that is not settled or whose loop in contact is unstable between the trial's K and
  /// the run's K; empty if all runs are settled.
  std::optional<Failing> first_failing(const TuneTrial& trial, std::size_t count,
                                       const std::function<std::string(std::size_t run)>& more);

  // ---- Limits on metrics

  /// Returns the current bound on a metric. Precondition: the metric has a limit.
  const MetricBound& limit_on(const std::string& metric) const { return limits_.at(metric); }
  /// Returns the violated limits of a trial, each with the factor > 1 by which the worst value is beyond its limit. A
  /// limited metric without a value has an infinite factor; a low-vibration rule whose number has no value counts as
  /// satisfied. Precondition: TuneTrial::worst is filled.
  TuneMetrics violated_limits(const TuneTrial& trial) const;
  /// Returns the number of violated limits and the largest factor of violated_limits(). Precondition:
  /// TuneTrial::worst is filled.
  std::pair<std::size_t, double> excess(const TuneTrial& trial) const;
  /// Returns the trial with the smallest excess() among the trials that violate only limits on metrics; null if there
  /// is no such trial.
  const TuneTrial* nearest() const;
  /// Returns the error estimates of the metrics of the last verified trial.
  const TuneMetrics& error() const { return error_; }
  void set_error(TuneMetrics error) { error_ = std::move(error); }
  /// Tightens each limit of the user that the choice violates within error(), and re-evaluates all trials. Returns true
  /// if a limit was tightened.
  bool tighten_limits(const TuneTrial& choice);

  // ---- The largest K

  /// Returns the smallest K that is known to be unstable for a choice [N/m]; infinite if none is known.
  double smallest_unstable() const { return smallest_unstable_; }
  /// Records that a choice is unstable at K [N/m].
  void note_unstable(double K);
  /// Returns the largest K of the search [N/m].
  double cap() const { return cap_; }
  /// Limits the search to K <= `cap` [N/m]. Trials at a larger K fail with this constraint and reason.
  void set_cap(double cap, std::string constraint, std::string reason);
  /// Returns the infeasible trial that represents all K above the cap.
  const TuneTrial& end() const { return end_; }

  // ---- Cost

  /// Returns the number of simulations so far.
  std::size_t runs() const { return runs_; }
  /// Adds simulations that were made outside of this class.
  void count_runs(std::size_t count) { runs_ += count; }

 private:
  LoadedScenario load(const TuneSetting& setting, double stiffness, const SceneVariant& variant,
                      const std::string& more = {}) const;
  void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job);
  TuneMetrics metrics_of(const Result& run) const;
  std::optional<std::string> unstable_loop(Scenario scenario, double lambda, double K, double most) const;
  bool judge_loop(TuneTrial& trial, const SceneVariant& variant, double lambda, const std::string& own_hand) const;
  void judge_motion(TuneTrial& trial, std::size_t first, std::size_t last);
  void judge_limits(TuneTrial& trial);
  void judge_worst(TuneTrial& trial) const;
  void judge(TuneTrial& trial);
  TuneTrial& mutable_trial(const TuneSetting& setting, double stiffness);

  const TuneQuestion& question_;
  const std::string& algorithm_;
  TuneRanges ranges_;
  bool over_hands_;
  bool requires_low_vibration_;
  /// Current bounds of metrics: the limits of the question, tightened by the error estimates.
  std::map<std::string, MetricBound> limits_;
  std::vector<SceneVariant> variants_;  ///< the scene itself first
  std::shared_ptr<const PointShell> shell_;
  std::optional<double> springs_lambda_;  ///< lambda_of() for springs in permanent contact; empty otherwise
  double smallest_unstable_;
  double cap_;
  TuneTrial end_;
  TuneMetrics error_;
  std::map<std::pair<TuneSetting, double>, TuneTrial> all_;
  std::size_t runs_ = 0;
};

}  // namespace hapbench
