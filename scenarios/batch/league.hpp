#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>
#include "results/io/columns.hpp"
#include "scenarios/batch/run_batch.hpp"
#include "scenarios/input/json_file.hpp"

/// Ranks algorithms by their metrics in each scenario and over all scenarios.
namespace hapbench {

/// The data that the league takes from one run.
struct LeagueRun {
  std::string outcome;
  bool failed = false;           ///< its metrics do not count
  std::uint64_t state_hash = 0;  ///< equal for runs that a seed does not change
  std::vector<std::optional<double>> metrics;
  std::vector<std::optional<double>> tolerances = {};  ///< of these; may be shorter
};

/// The runs of a league.
struct LeagueRuns {
  std::vector<std::string> scenarios;
  std::vector<std::string> algorithms;
  std::vector<std::string> metrics;
  std::vector<Better> better;  ///< for each metric
  std::size_t seeds = 1;
  std::vector<LeagueRun> runs;  ///< by scenario, then by algorithm, then by seed

  const LeagueRun& run(std::size_t scenario, std::size_t algorithm, std::size_t seed) const {
    return runs[(scenario * algorithms.size() + algorithm) * seeds + seed];
  }
};

/// Means whose relative difference is below this share a rank: the resolution of a table of ratios with three digits.
/// Rounding errors, by which equivalent algorithms differ, are far smaller.
inline constexpr double kSameRank = 1e-3;

/// One algorithm in one scenario, judged by one metric over the common seeds of the scenario (League::common).
struct Standing {
  std::optional<double> mean;    ///< none when its runs failed or no run has the metric
  std::optional<double> spread;  ///< sample standard deviation; none for one seed or if seeds change nothing
  /// By how much the mean may be wrong: the mean of what its numbers may be wrong by; none where none is known.
  std::optional<double> tolerance = {};
  /// 1 + the number of better algorithms. Those without failures come first, ordered by their means; means within
  /// kSameRank of the first of a group share its rank, and algorithms without a mean come last of these (a tool that is
  /// thrown out at once has no settled force). The others follow by their number of failed seeds. None if no algorithm
  /// has the metric, or no direction of it is better.
  std::optional<std::size_t> rank;
};

/// One algorithm over all scenarios and metrics.
struct LawStanding {
  std::size_t algorithm = 0;
  std::optional<double> mean_rank;  ///< mean of its ranks, including those for failures
  std::vector<std::size_t> fails;   ///< scenarios in which at least one seed failed
};

struct League {
  LeagueRuns runs;
  std::vector<bool> seeds_matter;  ///< for each scenario: whether the seed changes the run
  /// For each scenario the seeds over which the means are, so that they are about the same runs: those in which no
  /// algorithm failed that has any success; if there are none, all seeds of the algorithms that never failed.
  std::vector<std::vector<std::size_t>> common;
  std::vector<Standing> standings;
  std::vector<LawStanding> laws;  ///< best mean rank first

  const Standing& at(std::size_t scenario, std::size_t algorithm, std::size_t metric) const {
    return standings[(scenario * runs.algorithms.size() + algorithm) * runs.metrics.size() + metric];
  }
  /// Number of seeds with which an algorithm failed in a scenario.
  std::size_t failures(std::size_t scenario, std::size_t algorithm) const;
  /// How its runs ended: "completes", or with counts "completes 3; diverges 2".
  std::string outcomes(std::size_t scenario, std::size_t algorithm) const;
};

/// Precondition: there is a run for each scenario, algorithm and seed, each with all metrics.
League make_league(LeagueRuns runs);

/// Metrics that leagues and maps show by default: what the hand feels, and how deep the tool sinks in.
inline constexpr std::string_view kDefaultMetrics[] = {"force_rms_above_30Hz_N", "force_step_p99_N", "inside_max_m"};
/// Defaults if every run has a reference force to compare with: magnitude, direction, artefacts, noise.
inline constexpr std::string_view kFidelityMetrics[] = {"fidelity.force_error_relative",
                                                        "fidelity.force_direction_error_rad",
                                                        "fidelity.force_artefact_share", "force_rms_above_30Hz_N"};
/// kDefaultMetrics, separated by commas.
std::string default_metrics_text();

/// Returns true for the name of an outcome after which a run's metrics say nothing about its algorithm (OutcomeInfo).
bool is_failure(std::string_view outcome);

/// True when every run has a reference force.
bool have_reference(std::span<const RunReport> runs);

/// The runs of a finished batch with the given metrics (names of metric_list). If `metrics` is empty, they are
/// kFidelityMetrics if every run has a reference force, otherwise kDefaultMetrics. A run has failed if its outcome is a
/// failure or is not one that its scenario expects.
LeagueRuns league_runs(const BatchPlan& plan, const BatchReport& report, const std::vector<std::string>& metrics);

/// The columns of league.csv, a table with a row for each scenario, algorithm and metric.
std::vector<Column> league_columns();

/// Writes league.csv. Throws IoError.
void write_league(const std::filesystem::path& file, const League& league);

/// The same rows as objects, null for missing values, and a summary of each algorithm.
Json league_json(const League& league);

}  // namespace hapbench
