#pragma once

#include "scenarios/cases/comparison.hpp"

/// Ranks algorithms by their metrics in each scenario and over all scenarios; means and what chance makes of them.
namespace hapbench {

/// NaN if empty.
double mean_of(const std::vector<double>& values);
/// Standard deviation of a sample, with n - 1 in the denominator; 0 for fewer than two values.
double standard_deviation(const std::vector<double>& values);
/// Standard error of the mean: standard deviation / sqrt(n); 0 for fewer than two values.
double standard_error(const std::vector<double>& values);
/// Student's t of a paired test; 0 for fewer than two pairs, infinite when all pairs have the same difference.
double paired_t(const std::vector<double>& a, const std::vector<double>& b);
/// Two-sided 5 % quantile of Student's t, to 5e-4; infinite for 0 degrees of freedom. Beyond 10 that of 10, which is a
/// little strict: an experiment of the thesis has six subjects.
double critical_t(std::size_t degrees);

/// The data that the league takes from one run.
struct LeagueRun {
  std::string outcome;
  bool failed = false;           ///< its metrics do not count
  std::uint64_t state_hash = 0;  ///< equal for runs that a seed does not change
  std::vector<std::optional<double>> metrics;
  std::vector<std::optional<double>> tolerances;  ///< of these
};

/// Numbers whose relative difference is below this count as equal: the resolution of a table of ratios with three
/// digits. Rounding errors, by which equivalent algorithms differ, are far smaller.
inline constexpr double kSameRank = 1e-3;

/// A number of a table and what is known of its error.
struct NumberWithError {
  std::optional<double> value, error;
};
/// True when the first number is less by more than both errors and by more than kSameRank of the larger one.
/// Precondition: both have a value and an error.
bool is_less(const NumberWithError& a, const NumberWithError& b);

/// One algorithm in one scenario, judged by one metric over the common seeds of the scenario (League::common).
struct Standing {
  std::string scenario, algorithm, metric;
  std::uint64_t seeds = 1, failed = 0;
  std::string outcome;                ///< how its runs ended: "completes", or with counts "completes 3; diverges 2"
  std::optional<double> mean = {};    ///< none when its runs failed or no run has the metric
  std::optional<double> spread = {};  ///< sample standard deviation; none for one seed or if seeds change nothing
  /// Error of the mean: the mean of the errors of its numbers; empty if none is known.
  std::optional<double> tolerance = {};
  /// 1 + the number of algorithms that did better. Those without failures come first, by their means (is_less()), and
  /// of these last algorithms without a mean (a tool that is thrown out at once has no settled force). The others
  /// follow by their number of failed seeds. None if no algorithm has the metric, or no direction of it is better.
  std::optional<std::uint64_t> rank = {};
  std::uint64_t common_seeds = 1;
  Better better = Better::less;

  NumberWithError number() const { return {mean, tolerance.value_or(0.0)}; }
};

/// One algorithm over all scenarios and metrics.
struct LawStanding {
  std::string algorithm;
  std::optional<double> mean_rank;  ///< mean of its ranks, including those for failures
  std::vector<std::string> fails;   ///< scenarios in which at least one seed failed
};

/// The runs of a comparison, and what rank() makes of them.
struct League {
  std::vector<std::string> scenarios, algorithms, metrics;
  std::vector<Better> better;  ///< for each metric
  std::size_t seeds = 1;
  std::vector<LeagueRun> runs;  ///< by scenario, then by algorithm, then by seed

  std::vector<bool> seeds_matter = {};  ///< for each scenario: whether the seed changes the run
  /// For each scenario the seeds over which the means are, so that they are about the same runs: those in which no
  /// algorithm failed that has any success; if there are none, all seeds of the algorithms that never failed.
  std::vector<std::vector<std::size_t>> common = {};
  std::vector<Standing> standings = {};  ///< by scenario, then by algorithm, then by metric
  std::vector<LawStanding> laws = {};    ///< best mean rank first

  /// Precondition: there is a run for each scenario, algorithm and seed, each with all metrics.
  void rank();

  std::span<const LeagueRun> runs_of(std::size_t scenario, std::size_t algorithm) const {
    return std::span(runs).subspan((scenario * algorithms.size() + algorithm) * seeds, seeds);
  }
  const Standing& at(std::size_t scenario, std::size_t algorithm, std::size_t metric) const {
    return standings[(scenario * algorithms.size() + algorithm) * metrics.size() + metric];
  }
  /// Number of seeds with which an algorithm failed in a scenario.
  std::size_t failures(std::size_t scenario, std::size_t algorithm) const;
};

/// Metrics that leagues and maps show by default: what the hand feels, and how deep the tool sinks in.
inline constexpr std::string_view kDefaultMetrics[] = {"force_rms_above_30Hz_N", "force_step_p99_N", "inside_max_m"};
/// Defaults if every run has a reference force to compare with: magnitude, direction, artefacts, noise.
inline constexpr std::string_view kFidelityMetrics[] = {"fidelity.force_error_relative",
                                                        "fidelity.force_direction_error_rad",
                                                        "fidelity.force_artefact_share", "force_rms_above_30Hz_N"};

/// Returns true for the name of an outcome after which a run's metrics say nothing about its algorithm (OutcomeInfo).
bool is_failure(std::string_view outcome);

/// True when every run has a reference force.
bool have_reference(std::span<const Result> runs);

/// The league of a finished comparison with the given metrics (names of summary.json). If `metrics` is empty, they are
/// kFidelityMetrics if every run has a reference force, otherwise kDefaultMetrics. A run has failed if its outcome is a
/// failure or is not one that its scenario expects.
League league_of(const Comparison& comparison, std::span<const Result> reports,
                 const std::vector<std::string>& metrics);

}  // namespace hapbench
