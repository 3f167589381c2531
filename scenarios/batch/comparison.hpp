#pragma once

#include <span>

#include "scenarios/batch/cases.hpp"
#include "scenarios/run/run_scenario.hpp"

/// Scenes, each under the same laws and with the same number of seeds; and their league, which ranks the laws by their
/// metrics in each scene and over all scenes.
namespace hapbench {

/// The scenario's seed and those after it. Unless `jitter` [m] is 0, a shift of the start by that length goes along
/// with each, whose direction depends only on the seed, so that all algorithms start from the same places: uniform on
/// the sphere, in planar scenes on the circle z = 0.
Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter);

/// The question of `compare`.
struct ComparisonQuestion {
  std::vector<std::filesystem::path> scenarios;  ///< files
  std::vector<std::string> algorithms;
  std::vector<std::string> overrides = {};  ///< of all runs, as in --set
  std::uint64_t seeds = 1;                  ///< repetition k has the scenario's seed + k
  double jitter = 0.0;                      ///< length of a random shift of the start [m]
};

/// A comparison that was checked before its first run. Runs are numbered by scene first, then by algorithm, then by
/// seed. A scene has cases of its own, because its seeds and starts are.
struct Comparison {
  std::vector<Cases> scenes;
  std::vector<std::string> names;  ///< unique names of the scenes' files, without extension
  std::vector<std::string> algorithms;
  std::size_t seeds = 1;
  std::vector<std::string> warnings = {};  ///< without duplicates

  /// Runs of a scene.
  std::size_t each() const { return algorithms.size() * seeds; }
  std::size_t size() const { return scenes.size() * each(); }
  std::size_t scene(std::size_t run) const { return run / each(); }
  const std::string& algorithm(std::size_t run) const { return algorithms[run % each() / seeds]; }
  /// The scenario of a run. Thread-safe.
  LoadedScenario load(std::size_t run) const { return scenes[scene(run)].load(run % each()); }
  /// The folder of a scene's tables in that of the comparison: SCENARIO if there are several scenes, else empty.
  std::filesystem::path scene_folder(std::size_t scene) const { return scenes.size() > 1 ? names[scene] : ""; }
  /// The folder of a run's files in that of the comparison: [SCENARIO/]ALGORITHM[/seed_K], the parts in brackets where
  /// there are several.
  std::filesystem::path folder(std::size_t run) const;
};

/// Loads every scene with every algorithm and reads the files they name. Throws InputError for the first that is wrong,
/// for two scenes of one name, and where jitter cannot shift the start because the motion prescribes it.
Comparison planned(const ComparisonQuestion& question);

/// Runs all cases of a list, numbered one after the other, and writes the files of each into the folder that `folder`
/// names, or none without it. Runs in one environment share its shell. Neither reports nor files depend on the number
/// of jobs. Reports have no targets, of which there may be very many; files have them. Throws IoError and Stopped.
std::vector<Result> run_all(std::span<const Cases> cases, const JobOptions& jobs,
                            const std::function<std::filesystem::path(std::size_t run)>& folder = {});

/// Removes what an earlier comparison of these scenes left in a folder: its tables, and the files of runs of any law
/// and seed. Other files stay.
void remove_earlier_comparison(const std::filesystem::path& folder, const Comparison& comparison);

// ---- Means, and what chance makes of them

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

// ---- The league

/// Numbers whose relative difference is below this count as equal: the resolution of a table of ratios with three
/// digits, far above rounding errors, by which equivalent algorithms differ.
inline constexpr double kSameRank = 1e-3;

/// A number of a table and what is known of its error.
struct NumberWithError {
  std::optional<double> value = {}, error = {};
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
