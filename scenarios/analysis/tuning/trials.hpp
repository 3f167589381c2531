#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/analysis/tuning/family.hpp"
#include "scenarios/analysis/tuning/trial.hpp"
#include "scenarios/analysis/tuning/tune_question.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// The trials of one law: settings at stiffnesses, each run with every member of the families and judged.
namespace hapbench {

inline constexpr double kTuneResolution = 5e-3;  ///< relative width at which a search for K stops

/// A run that is not settled.
struct Failing {
  std::size_t run;  ///< its number
  std::string why;
};

/// All trials of one law so far.
///
/// Invariant: every setting and stiffness is run and judged once, when it is first requested, and its judgement follows
/// the current limits: tighten_limits() judges all trials anew. The largest K that may be tried only decreases, so that
/// a K that failed a verification stays out of reach. runs() counts every simulation.
class Trials {
 public:
  /// `question` and `algorithm` must outlive this.
  Trials(const TuneQuestion& question, const std::string& algorithm);

  // ---- The question

  const TuneQuestion& question() const { return question_; }
  const TuneRanges& ranges() const { return ranges_; }
  /// Returns the number of runs of a trial at K: the scene's own run, and one for each member of the families.
  std::size_t family_size() const { return family_.size(); }
  /// Returns true if the families have other hands.
  bool over_hands() const { return over_hands_; }
  /// Returns true if the user gave no limits: the own run must have low vibration.
  bool is_quiet() const { return is_quiet_; }
  /// Returns the overrides that make the scene a trial.
  std::vector<std::string> overrides(const TuneSetting& setting, double stiffness) const;
  /// Loads the scene's own run of a trial.
  LoadedScenario load(const TuneSetting& setting, double stiffness) const;

  // ---- Trials

  /// Runs and judges a trial, unless it has been tried before.
  const TuneTrial& tried(const TuneSetting& setting, double stiffness);
  /// Returns the trial; above the largest K that may be tried, a trial that fails for the reason of that bound.
  const TuneTrial& beyond(const TuneSetting& setting, double K);
  bool feasible(const TuneSetting& setting, double K) { return beyond(setting, K).feasible(); }
  /// Tries, and if the own run is settled also measures its metrics.
  void try_and_measure(const TuneSetting& setting, double stiffness);
  /// Gives a trial the metrics of the scene's own run, unless it has them.
  void measure(TuneTrial& trial);
  /// Returns all trials, by setting and K.
  const std::map<std::pair<TuneSetting, double>, TuneTrial>& all() const { return all_; }
  /// Returns the largest eigenvalue of the stiffness in contact in a trial, in units of K.
  double lambda_of(const TuneTrial& trial) const { return springs_lambda_.value_or(trial.lambda_max); }
  /// Makes `count` runs of a trial, in which the members of the families take turns, each with a further override, such
  /// as a larger K. Returns the first run that is not settled, or whose loop in contact is unstable at some K up to
  /// that of the run; empty if there is none.
  std::optional<Failing> first_failing(const TuneTrial& trial, std::size_t count,
                                       const std::function<std::string(std::size_t run)>& more);

  // ---- Limits on metrics

  /// Returns the bound that a metric has to keep now. Precondition: it is limited.
  const MetricBound& limit_on(const std::string& metric) const { return limits_.at(metric); }
  /// Returns the violated limits of a trial, each with the ratio of the worst value to its limit: more than 1, infinite
  /// without a value, which is allowed only for the rules of low vibration. Precondition: the trial was judged by
  /// limits.
  TuneMetrics broken_limits(const TuneTrial& trial) const;
  /// Returns the number of violated limits and the largest of these ratios. Same precondition.
  std::pair<std::size_t, double> excess(const TuneTrial& trial) const;
  /// Returns the trial with the smallest excess among the trials that violate nothing but limits; null without any.
  const TuneTrial* nearest() const;
  /// Returns the known errors of the metrics of the last trial that was verified.
  const TuneMetrics& error() const { return error_; }
  void set_error(TuneMetrics error) { error_ = std::move(error); }
  /// Tightens the limits of the user that the choice does not keep by as much as error(), and judges all trials anew.
  /// Returns true if there was such a limit.
  bool tighten_limits(const TuneTrial& choice);

  // ---- The largest K

  /// Returns the smallest K that is known to be unstable at a choice [N/m]; infinite if there is none.
  double refuted() const { return refuted_; }
  /// Notes that a choice is unstable at K.
  void note_unstable(double K);
  /// Returns the largest K that may be tried [N/m].
  double cap() const { return cap_; }
  /// Lets no K above `cap` be tried any more: its constraint fails for this reason.
  void set_cap(double cap, std::string constraint, std::string reason);
  /// Returns the trial that stands for all K above the cap.
  const TuneTrial& end() const { return end_; }

  // ---- Cost

  /// Returns the number of simulations so far.
  std::size_t runs() const { return runs_; }
  /// Counts simulations that were made for these trials elsewhere.
  void count_runs(std::size_t count) { runs_ += count; }

 private:
  LoadedScenario load(const TuneSetting& setting, double stiffness, const FamilyMember& member,
                      const std::string& more = {}) const;
  void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job);
  TuneMetrics metrics_of(const Result& run) const;
  std::optional<std::string> unstable_loop(Scenario scenario, double lambda, double K, double most) const;
  bool judge_loop(TuneTrial& trial, const FamilyMember& member, double lambda, const std::string& own_hand) const;
  void judge_motion(TuneTrial& trial, std::size_t first, std::size_t last);
  void judge_limits(TuneTrial& trial);
  void judge_worst(TuneTrial& trial) const;
  void judge(TuneTrial& trial);
  TuneTrial& mutable_trial(const TuneSetting& setting, double stiffness);

  const TuneQuestion& question_;
  const std::string& algorithm_;
  TuneRanges ranges_;
  bool over_hands_;
  bool is_quiet_;
  /// Allowed bounds of metrics: the limits of the question, tightened by the known errors.
  std::map<std::string, MetricBound> limits_;
  std::vector<FamilyMember> family_;  ///< the scene's own run first
  std::shared_ptr<const PointShell> shell_;
  std::optional<double> springs_lambda_;  ///< of springs, which does not depend on the position of the tool
  double refuted_;
  double cap_;
  TuneTrial end_;
  TuneMetrics error_;
  std::map<std::pair<TuneSetting, double>, TuneTrial> all_;
  std::size_t runs_ = 0;
};

}  // namespace hapbench
