#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/number_with_error.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Ranks the laws of a comparison by their metrics, in each scene and over all scenes.
namespace hapbench {

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
  std::span<const Result> runs;  ///< by scenario, then by algorithm, then by seed; they must outlive the league
  std::vector<bool> failed;      ///< of each run: its metrics do not count

  std::vector<bool> seeds_matter = {};  ///< for each scenario: whether the seed changes the run
  /// For each scenario the seeds over which the means are: those in which no algorithm failed that has any success; if
  /// there are none, all seeds of the algorithms that never failed.
  std::vector<std::vector<std::size_t>> common = {};
  std::vector<Standing> standings = {};  ///< by scenario, then by algorithm, then by metric
  std::vector<LawStanding> laws = {};    ///< best mean rank first

  /// Precondition: there is a run for each scenario, algorithm and seed.
  void rank();

  /// The number of an algorithm's first run in a scenario; those of its other seeds follow.
  std::size_t first_run(std::size_t scenario, std::size_t algorithm) const {
    return (scenario * algorithms.size() + algorithm) * seeds;
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

/// True for the name of an outcome after which a run's metrics say nothing about its algorithm (OutcomeInfo).
bool is_failure(std::string_view outcome);

/// True when every run has a reference force.
bool have_reference(std::span<const Result> runs);

/// The league of a finished comparison with these metrics (names of summary.json; none: kFidelityMetrics if every run
/// has a reference force, else kDefaultMetrics). A run has failed if its outcome is a failure or not one that its
/// scenario expects.
League league_of(const Comparison& comparison, std::span<const Result> reports,
                 const std::vector<std::string>& metrics);

}  // namespace hapbench
