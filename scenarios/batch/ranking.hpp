#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/number_with_error.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Ranks the force laws of a comparison by their metrics, in each scene and over all scenes.
namespace hapbench {

/// The algorithm whose constraints are the constraints of rigid contact.
inline constexpr std::string_view kSharesReference = "proxy";

/// Result of one algorithm in one scenario for one metric, over the scenario's common seeds (Ranking::common).
struct RankingEntry {
  std::string scenario, algorithm, metric;
  std::uint64_t seeds = 1, failed = 0;
  /// How the runs ended: the common outcome, such as "completes", if all outcomes are equal; otherwise the outcomes
  /// with counts, such as "completes 3; diverges 2".
  std::string outcome;
  std::optional<double> mean = {};  ///< mean of the metric; empty if all runs failed or no run has the metric
  /// Sample standard deviation of the metric over the seeds; empty for a single seed, or if the seed does not affect
  /// the run.
  std::optional<double> spread = {};
  /// Error of the mean: mean, over the runs, of the error of the metric; empty if no error is known.
  std::optional<double> tolerance = {};
  bool has_known_error = true;  ///< false if Ranking::estimated_error has no value for one of the runs
  /// 1 + the number of better algorithms. Algorithms without failures come first, in the order of their means
  /// (is_less()). Algorithms without failures and without a mean come after them: for example, a tool that is thrown
  /// out at once has no settled force. Algorithms with failures follow, in the order of their number of failed seeds.
  /// Empty if no algorithm has the metric, if neither smaller nor larger values are better, if only a bound of the mean
  /// is known (is_only_bounded()) or its error is unknown, or if all algorithms would have the same rank. Also empty if
  /// the reference force of the metric comes from the same constraints (Ranking::shares_reference()).
  std::optional<std::uint64_t> rank = {};
  std::uint64_t common_seeds = 1;
  Better better = Better::less;

  NumberWithError number() const { return {mean, tolerance.value_or(0.0)}; }
};

/// Result of one algorithm over all scenarios and metrics.
struct LawRankingEntry {
  std::string algorithm;
  /// Mean of the algorithm's ranks, including ranks for failures; empty if the algorithm has no rank.
  std::optional<double> mean_rank;
  std::vector<std::string> fails;  ///< scenarios in which the algorithm failed for at least one seed
};

/// Returns the estimated error of a metric of a run, by the index of the run; an empty value if it is unknown.
using EstimatedError = std::function<std::optional<double>(std::size_t run, const std::string& metric)>;

/// The runs of a comparison and their ranking. rank() computes all members from `depends_on_seed` on.
struct Ranking {
  std::vector<std::string> scenarios, algorithms, metrics;
  std::vector<Better> better;  ///< for each metric: whether smaller or larger values are better
  std::size_t seeds = 1;
  std::span<const Result> runs;  ///< ordered by scenario, then algorithm, then seed; must outlive this object
  std::vector<bool> failed;      ///< for each run: true if it failed, so that its metrics do not count
  /// For each scenario: true if the reference force is the force of rigid contact. The algorithm kSharesReference
  /// renders by the same constraints, so that its fidelity metrics get no rank.
  std::vector<bool> is_rigid_reference = {};
  /// Errors of the metrics; empty: the errors are the tolerances of the metrics.
  EstimatedError estimated_error = {};

  std::vector<bool> depends_on_seed = {};  ///< for each scenario: true if runs with different seeds differ
  /// For each scenario, the seeds over which means are computed. These are the seeds for which all algorithms
  /// succeeded, not counting algorithms that failed for every seed. If there is no such seed, all seeds are used, but
  /// failed runs do not count (lacks_common_seeds()).
  std::vector<std::vector<std::size_t>> common = {};
  std::vector<RankingEntry> entries = {};  ///< ordered by scenario, then algorithm, then metric
  std::vector<LawRankingEntry> laws = {};  ///< ordered by mean rank, best first

  /// Computes the ranks. Precondition: `runs` has a run for each scenario, algorithm and seed.
  void rank();

  /// Returns the number of an algorithm's first run in a scenario. Its runs with the other seeds follow.
  std::size_t first_run(std::size_t scenario, std::size_t algorithm) const {
    return (scenario * algorithms.size() + algorithm) * seeds;
  }
  const RankingEntry& at(std::size_t scenario, std::size_t algorithm, std::size_t metric) const {
    return entries[(scenario * algorithms.size() + algorithm) * metrics.size() + metric];
  }
  /// Returns true if the seed changes any run of a scenario.
  bool seeds_matter(std::size_t scenario) const;
  /// Returns true if a metric compares the force of an algorithm with a reference force from the same constraints.
  bool shares_reference(std::size_t scenario, std::size_t algorithm, std::size_t metric) const;
  /// Returns true if the means of the algorithms in a scenario are over different seeds, because no seed is common to
  /// all algorithms that succeeded at some seed.
  bool lacks_common_seeds(std::size_t scenario) const;
  /// Returns the number of seeds for which an algorithm failed in a scenario.
  std::size_t failures(std::size_t scenario, std::size_t algorithm) const;
};

/// Metrics that rankings and maps show by default: vibration and force steps, which the hand feels, and the
/// depth of the tool inside the surface.
inline constexpr std::string_view kDefaultMetrics[] = {"force_rms_above_30Hz_N", "force_step_p99_N", "inside_max_m"};
/// Default metrics if every run has a reference force: errors of magnitude and direction, artefacts, and noise.
inline constexpr std::string_view kFidelityMetrics[] = {"fidelity.force_error_relative",
                                                        "fidelity.force_direction_error_rad",
                                                        "fidelity.force_artefact_share", "force_rms_above_30Hz_N"};

/// Returns true for the name of an outcome after which the metrics of a run do not characterise its algorithm
/// (OutcomeInfo::is_failure).
bool is_failure(std::string_view outcome);

/// Returns true if every run has a reference force.
bool have_reference(std::span<const Result> runs);

/// Ranks the algorithms of a finished comparison by `metrics`, which are names of summary.json. Without metrics, uses
/// kFidelityMetrics if every run has a reference force, else kDefaultMetrics. A run has failed if its outcome is a
/// failure, or is not among the outcomes that its scenario expects. A tool that a script leads through the surface is
/// an exception: its run has not failed. One mean is better than another only if they differ by more than the sum of
/// their errors (is_less()). The errors are `estimated_error`; if it is empty, the tolerances of the metrics.
Ranking rank_comparison(const Comparison& comparison, std::span<const Result> reports,
                        const std::vector<std::string>& metrics, const EstimatedError& estimated_error = {});

}  // namespace hapbench
