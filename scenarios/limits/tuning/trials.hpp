#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/limits/tuning/tune.hpp"

namespace hapbench {

inline constexpr double kTuneResolution = 5e-3;  ///< of K

/// A run that is not settled.
struct Failing {
  std::size_t run;  ///< its number
  std::string why;
};

/// The trials of one law: settings at stiffnesses, each judged by the runs of the family when it is first asked for.
struct Trials {
  /// `question` and `algorithm` have to outlive this.
  Trials(const TuneQuestion& question, const std::string& algorithm);

  std::vector<std::string> overrides(const TuneSetting& setting, double stiffness) const;
  LoadedScenario load(const TuneSetting& setting, double stiffness, const FamilyMember& member,
                      const std::string& more = {}) const;
  void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job);
  TuneMetrics metrics_of(const Result& run) const;
  /// Gives the trial the metrics of the scene's own run, unless it has them.
  void measure(TuneTrial& trial);

  TuneTrial& tried(const TuneSetting& setting, double stiffness);
  bool feasible(const TuneSetting& setting, double stiffness) {
    return stiffness <= cap && tried(setting, stiffness).feasible();
  }
  /// The trial, or above `cap` the end.
  const TuneTrial& beyond(const TuneSetting& setting, double stiffness) {
    return stiffness <= cap ? tried(setting, stiffness) : end;
  }
  /// Runs the family for the metrics that are limited, and finds the first limit that is not kept.
  void judge_limits(TuneTrial& trial);
  /// Finds that limit anew. Precondition: judge_limits.
  void judge_worst(TuneTrial& trial) const;

  /// The first of so many runs of a trial, the family taking turns, that is not settled under a further override, such
  /// as a larger K, up to which the loop in contact has to be stable, too.
  std::optional<Failing> first_failing(const TuneTrial& trial, std::size_t count,
                                       const std::function<std::string(std::size_t run)>& more);

  /// How many times its limit the worst value is; at most 1 where it is kept, infinite without a value, but 0 in a run
  /// that is to be quiet.
  double times_limit(const TuneTrial& trial, const std::string& name, const MetricBound& bound) const;
  /// How many limits a trial does not keep, and the largest of times_limit.
  std::pair<int, double> excess(const TuneTrial& trial) const;
  /// Of the trials that only limits are in the way of, the one with the least excess; null without one.
  const TuneTrial* nearest() const;

  const TuneQuestion& question;
  const std::string& algorithm;
  TuneRanges ranges;
  std::vector<FamilyMember> family = {{"the scene's own run"}};
  std::shared_ptr<const PointShell> shell;
  std::optional<double> springs_lambda;  ///< of springs, which their place does not change
  bool over_hands;                       ///< the family has other hands
  bool is_quiet;                         ///< the limits are those of a quiet run
  /// What is allowed: the limits of the question less what is known of errors.
  std::map<std::string, MetricBound> limits;
  double refuted = std::numeric_limits<double>::infinity();  ///< least K known not to be settled at a choice [N/m]
  double cap;                                                ///< largest K that may be tried for all that [N/m]
  TuneTrial end;                                             ///< beyond `cap` or the range: only the reason counts
  TuneMetrics error;                                         ///< of the choice that was looked at last
  std::map<std::pair<TuneSetting, double>, TuneTrial> all;
  std::size_t runs = 0;

 private:
  void judge_motion(TuneTrial& trial, std::size_t first, std::size_t last);
  bool judge_loop(TuneTrial& trial, std::size_t member, double lambda, const std::string& own_hand) const;
};

}  // namespace hapbench
