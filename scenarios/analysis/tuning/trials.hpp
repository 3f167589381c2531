#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/trial_runs.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"

/// The trials of one law: settings with stiffnesses, each evaluated in every variant of the scene.
namespace hapbench {

inline constexpr double kTuneResolution = 5e-3;  ///< relative width at which a search for K stops

/// A run that violates the constraint "settled": it is not stable by rule_of().
struct Failing {
  std::size_t run;  ///< index of the run, from 0
  std::string why;  ///< reason, for the user
};

/// States how far a trial is evaluated. Each value includes the values before it. The run of the scene itself suffices
/// to find a violated limit; the other variants and the errors of metrics can only add failures.
enum class Need {
  feasibility,  ///< whether the trial keeps all constraints
  softness,     ///< also whether a larger K may help (TuneTrial::too_soft)
  excess,       ///< also the factor by which limits are violated, with the errors of the limited metrics
  all           ///< the same as `excess`, but also for a trial that is far from the limits
};

/// The limits of a search.
struct TuneLimits {
  std::map<std::string, MetricBound> metrics = {};  ///< limits of the user
  bool allow_vibration = false;                     ///< see TuneQuestion

  /// Returns one end of the limit on a metric; empty for no limit. Precondition: `metrics` has the metric.
  std::optional<double>& at(const LimitEnd& end) {
    MetricBound& bound = metrics.at(end.metric);
    return end.is_max ? bound.max : bound.min;
  }
};

/// Evaluates and stores all trials of one law.
///
/// Invariants:
/// - each run of a setting and stiffness is made once, when a search first needs it or by run_ahead();
/// - whether a trial is feasible depends only on the trial, on the limits and on the refutations of this search
///   (refute()). A trial that keeps some limits therefore keeps all looser limits. The metrics of a feasible trial keep
///   the limits even with their errors added;
/// - a search uses only trials that it requested itself. Its result and its number of runs do not depend on earlier
///   searches;
/// - a trial is evaluated only as far as a caller needs it (Need). The results equal the results of a complete
///   evaluation, except that TuneTrial::binding and `why` of an infeasible trial may lack a later failure or the error;
/// - runs() does not depend on the number of threads: of runs that end at the first failure, it counts the runs up to
///   this failure, and not the runs that other threads had already begun.
class Trials {
 public:
  /// `question` and `algorithm` must outlive this object.
  Trials(const TuneQuestion& question, const std::string& algorithm);

  const TuneQuestion& question() const { return question_; }
  const TuneRanges& ranges() const { return trial_runs_.ranges(); }
  /// Returns the number of variants, including the scene itself. A trial makes this number of runs at K.
  std::size_t variant_count() const { return trial_runs_.variant_count(); }
  /// Returns the scenarios, runs and loops of the trials.
  const TrialRuns& trial_runs() const { return trial_runs_; }

  // ---- Searches

  /// Starts a search with these limits: forgets which trials were requested, which were refuted, and the smallest
  /// unstable K.
  void begin_search(TuneLimits limits);
  /// The same as begin_search(), but keeps the refutations and the smallest unstable K.
  void change_limits(TuneLimits limits);
  const TuneLimits& limits() const { return limits_; }
  /// Returns true if the search has reached its maximum number of runs (kMaxTuneRuns). New trials then fail.
  bool is_exhausted() const { return search_runs_ >= kMaxTuneRuns; }
  /// Counts all trials of all searches as trials of this search, and judges them by the current limits.
  void recall_all();

  // ---- Trials

  /// Returns the trial of a setting at K [N/m]. Runs it first if necessary.
  const TuneTrial& trial_at(const TuneSetting& setting, double stiffness);
  /// Runs the scene itself with a setting at several stiffnesses [N/m] on all threads, so that trial_at() needs no
  /// further run of the scene itself. First runs each K, then G K where the run at K is settled, and then measures the
  /// trials that have not failed. The runs count for a search when it requests the trial, which the caller must do for
  /// each stiffness. Does nothing if the search might then exceed its maximum number of runs.
  void run_ahead(const TuneSetting& setting, std::span<const double> stiffnesses);
  /// Returns true if a setting is feasible at K [N/m].
  bool feasible(const TuneSetting& setting, double K) { return trial_at(setting, K).feasible(); }
  /// Returns true if a setting at K [N/m] is infeasible and a larger K may keep its constraints.
  bool is_too_soft(const TuneSetting& setting, double K);
  /// Evaluates a trial further and returns it.
  const TuneTrial& evaluated(const TuneTrial& trial, Need need);
  /// Estimates the errors that metrics of a trial still lack, and returns the trial.
  const TuneTrial& with_errors(const TuneTrial& trial);
  /// Evaluates a trial, and measures its metrics if the run of the scene itself is settled.
  void evaluate_and_measure(const TuneSetting& setting, double stiffness);
  /// Returns all trials of all searches, by setting and K.
  const std::map<std::pair<TuneSetting, double>, TuneTrial>& all() const { return all_; }
  /// Returns the feasible trial of this search with the largest K; null if no trial is feasible.
  const TuneTrial* stiffest_feasible() const;
  /// Returns the stiffnesses of the feasible trials of a setting in this search [N/m].
  std::vector<double> feasible_stiffnesses(const TuneSetting& setting) const;
  /// Returns copies of the feasible trials of this search, by setting and K.
  std::vector<TuneTrial> feasible_trials() const;
  /// Returns up to `count` trials of this search that violate only limits, at most one for each setting, the smallest
  /// excess() first.
  std::vector<const TuneTrial*> nearest(std::size_t count);
  /// Returns the `count` trials with the smallest excess() among `trials`, smallest first. The returned trials are
  /// evaluated as far as Need::excess. Leaves out trials for which `counts` returns false after this evaluation. With
  /// `one_per_setting`, also leaves out all trials of a setting except its trial with the smallest excess().
  std::vector<const TuneTrial*> smallest_excess(std::vector<const TuneTrial*> trials, std::size_t count,
                                                bool one_per_setting,
                                                const std::function<bool(const TuneTrial&)>& counts);
  /// Returns true if a trial violates only limits, and its excess() is smaller than the excess() of `other`.
  bool is_nearer(const TuneTrial& trial, const TuneTrial& other);
  /// Makes up to `count` runs of a trial; the runs cycle through the variants. `more`: additional override of a run,
  /// such as a larger K. Returns the first run that is not settled or whose loop in contact is unstable between the
  /// trial's K and the run's K; empty if all runs are settled.
  std::optional<Failing> first_failing(const TuneTrial& trial, std::size_t count,
                                       const std::function<std::string(std::size_t run)>& more);

  /// Runs the scene itself in a trial in the same way as the command `run`, and returns the findings of its diagnosis.
  /// The run does not count for the search.
  std::vector<Diagnosed> findings(const TuneTrial& trial);
  /// Runs the scene itself with a setting at each stiffness [N/m]. Returns for each run how it vibrates: its verdict
  /// `vibrating` or `diverged`, or a violated rule of low vibration; empty if neither. Makes one or two runs for
  /// each stiffness, which do not count for the search.
  std::vector<std::optional<TuneFailure>> vibrations(const TuneSetting& setting,
                                                     const std::vector<double>& stiffnesses);
  /// Returns how the scene itself vibrates in the trials of this search with the setting and a stiffness in the range
  /// [N/m], as far as the trials were evaluated. Trials without a vibration are left out. The keys are the stiffnesses.
  std::map<double, TuneFailure> known_vibrations(const TuneSetting& setting, const Range& stiffnesses) const;

  // ---- Limits on metrics

  /// Returns the violated limits of a trial, each with the factor > 1 by which the extreme value and its error are
  /// beyond the limit. If both ends of a limit are violated, returns the larger factor. A limited metric without a
  /// value has an infinite factor. A low-vibration rule without a value counts as kept.
  MetricValues violated_limits(const TuneTrial& trial) const;
  /// Returns true for the name of a low-vibration rule.
  bool is_rule(const std::string& name) const { return rules_.contains(name); }
  /// Returns the largest factor of violated_limits(); 1 if no limit is violated. If the trial was not evaluated as far
  /// as Need::excess, the returned factor is only a lower bound.
  double excess(const TuneTrial& trial) const;

  // ---- Verification

  /// Refutes a choice that failed a verification: marks the trials of its setting with K from `from` to `to` [N/m] as
  /// infeasible. Until restrict_refutations() is called, also marks the trials of settings with the same filter whose
  /// zeta and mass differ from the choice by a factor of less than 4/3.
  void refute(const TuneSetting& setting, double from, double to, std::string constraint, std::string reason);
  /// Restricts every refutation to the setting that failed. Returns false if there are no refutations or they are
  /// already restricted.
  bool restrict_refutations();
  /// Returns the refutation of the choice that failed last; null if no choice was refuted.
  const TuneFailure* last_refuted() const { return last_refuted_ ? &*last_refuted_ : nullptr; }
  /// Returns the smallest K that is known to be unstable for a choice [N/m]; infinite if none is known.
  double smallest_unstable() const { return smallest_unstable_; }
  /// Records that a choice is unstable at K [N/m].
  void note_unstable(double K);

  // ---- Cost

  /// Returns the number of runs so far.
  std::size_t runs() const { return runs_; }
  /// Adds runs that were made outside of this class.
  void count_runs(std::size_t count) { runs_ += count; }
  /// Sets the purpose of the next runs, which is passed to TuneQuestion::on_runs.
  void begin_purpose(std::string purpose);
  /// Sets the relaxation that the next searches are to confirm; empty: none.
  void set_aim(std::string aim) { aim_ = std::move(aim); }

 private:
  struct Refutation {
    TuneSetting setting;
    double from, to;
    std::string constraint, reason;
  };

  void in_parallel(TuneTrial* trial, std::size_t count, const std::function<void(std::size_t)>& job);
  std::size_t run_until_failure(TuneTrial* trial, std::size_t count, const std::function<bool(std::size_t)>& holds);
  void in_parallel(std::span<TuneTrial* const> trials, const std::function<void(std::size_t)>& job);
  void count_runs(TuneTrial* trial, std::size_t count);
  void record(TuneTrial& trial, std::size_t variant, const MotionOfVariant& motion) const;
  void judge_motion(TuneTrial& trial, std::size_t first, std::size_t last);
  void measure_scene(TuneTrial& trial);
  void measure_variants(TuneTrial& trial);
  void refine(TuneTrial& trial, Refinement refinement);
  bool needs_depth(const TuneTrial& trial, Need need) const;
  bool violates_limits(const TuneTrial& trial) const { return !violated_limits(trial).empty(); }
  bool violates_only_depths(const TuneTrial& trial) const;
  bool violates_end(const TuneTrial& trial, const LimitEnd& end) const;
  std::string violation_text(const TuneTrial& trial, const LimitEnd& end) const;
  void report_runs() const;
  void judge_limits(TuneTrial& trial) const;
  void evaluate_motion(TuneTrial& trial);
  void evaluate(TuneTrial& trial, Need need);
  void judge(TuneTrial& trial, Need need = Need::feasibility);
  const Refutation* refutation_of(const TuneTrial& trial) const;
  TuneTrial& stored_trial(const TuneSetting& setting, double stiffness);
  TuneTrial& mutable_trial(const TuneSetting& setting, double stiffness);

  const TuneQuestion& question_;
  const std::string& algorithm_;
  TrialRuns trial_runs_;
  std::map<std::string, double> rules_;  ///< low-vibration rules with their thresholds
  TuneLimits limits_;
  double smallest_unstable_ = std::numeric_limits<double>::infinity();
  std::map<std::pair<TuneSetting, double>, TuneTrial> all_;
  std::set<const TuneTrial*> requested_;  ///< trials of this search
  std::vector<Refutation> refutations_;
  bool exact_refutations_ = false;
  std::optional<TuneFailure> last_refuted_;  ///< of all searches
  std::size_t runs_ = 0, search_runs_ = 0;
  std::string purpose_, aim_;
};

}  // namespace hapbench
