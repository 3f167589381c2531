#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Which algorithm did best, scenario by scenario, and over all of them.
namespace hapbench {

/// What the league takes from one run.
struct LeagueRun {
  std::string outcome;
  bool failed = false;           ///< its numbers say nothing about the algorithm
  std::uint64_t state_hash = 0;  ///< equal for runs that a seed does not change
  std::vector<std::optional<double>> metrics;
};

/// The runs of a league and what they are called. Of every metric less is better.
struct LeagueRuns {
  std::vector<std::string> scenarios;
  std::vector<std::string> algorithms;
  std::vector<std::string> metrics;
  std::size_t seeds = 1;
  std::vector<LeagueRun> runs;  ///< scenario by scenario, in there algorithm by algorithm, in there seed by seed

  const LeagueRun& run(std::size_t scenario, std::size_t algorithm, std::size_t seed) const {
    return runs[(scenario * algorithms.size() + algorithm) * seeds + seed];
  }
};

/// Means closer than this part of the larger share a rank: what a table of ratios with three digits can show. Rounding,
/// which sets apart algorithms that do the same, is far below.
inline constexpr double kSameRank = 1e-3;

/// One algorithm in one scenario by one metric, over the seeds that did not fail.
struct Standing {
  std::optional<double> mean;    ///< none when all failed or none has the metric
  std::optional<double> spread;  ///< sample standard deviation; none when seeds are one or change nothing
  /// 1 + the number of algorithms that did better: those without a failure by their means, where the ones within
  /// kSameRank of the first of a group share its rank, and those that have none behind (a tool that is thrown out at
  /// once has no settled force); then those with failures, by the number of seeds. None where nobody has the metric.
  std::optional<std::size_t> rank;
  std::optional<double> ratio_to_best;  ///< mean / best mean; none after a failure, and where the best is not > 0
  /// The difference to the best is more than the spread: |t| of the differences seed by seed beyond the two-sided 5 %
  /// quantile of Student's t (statistics.hpp). Each seed gives all algorithms the same start and noise, so differences
  /// are taken in pairs. Never true within kSameRank of the best. None for the best itself, after a failure, and where
  /// no spread is known.
  std::optional<bool> beyond_spread;
};

/// One algorithm over all scenarios and metrics.
struct LawStanding {
  std::size_t algorithm = 0;
  std::optional<double> mean_rank;   ///< of its ranks, those for failures included
  std::optional<double> mean_ratio;  ///< geometric mean of its ratios to the best
  std::size_t ratios = 0;            ///< how many those are
  std::vector<std::size_t> wins;     ///< scenarios in which nobody's ranks have a smaller mean, itself without failure
  std::vector<std::size_t> fails;    ///< scenarios in which at least one seed failed
};

struct League {
  LeagueRuns runs;
  std::vector<bool> seeds_matter;  ///< for each scenario: another seed gives another run
  std::vector<Standing> standings;
  std::vector<LawStanding> laws;  ///< best mean rank first

  const Standing& at(std::size_t scenario, std::size_t algorithm, std::size_t metric) const {
    return standings[(scenario * runs.algorithms.size() + algorithm) * runs.metrics.size() + metric];
  }
  /// Seeds of an algorithm that failed in a scenario.
  std::size_t failures(std::size_t scenario, std::size_t algorithm) const;
  /// How its runs ended: "completes", or of several ways "completes 3; diverges 2".
  std::string outcomes(std::size_t scenario, std::size_t algorithm) const;
};

/// Precondition: there are as many runs as the names and seeds say, each with all metrics.
League make_league(LeagueRuns runs);

}  // namespace hapbench
