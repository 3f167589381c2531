#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "results/io/columns.hpp"
#include "results/observe/step_times.hpp"
#include "results/observe/target_metrics.hpp"
#include "results/summary/outcome.hpp"
#include "results/summary/provenance.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Counts of the operations of a run. They are exact and reproducible; times are in timing.json.
struct RunWork {
  SearchWork search;
  std::uint64_t steps_skipped = 0;  ///< steps without a contact search
  AlgorithmWork algorithm;
  std::uint64_t allocations = 0;  ///< heap allocations inside the step loop

  RunWork& operator+=(const RunWork& other) noexcept {
    search += other.search;
    steps_skipped += other.steps_skipped;
    algorithm += other.algorithm;
    allocations += other.allocations;
    return *this;
  }
};

/// A warning that the results of a run may be misleading. The run is not rejected.
struct Warning {
  std::string kind;     ///< identifier of the reason; does not depend on the numbers in the text
  std::string pointer;  ///< JSON pointer of the field concerned; empty: the whole run
  std::string text;     ///< one sentence

  /// Returns the warning in the form that results contain: the JSON pointer, if any, and the text. Does not depend on
  /// the location of the files.
  std::string located_text() const { return pointer.empty() ? text : pointer + ": " + text; }

  bool operator==(const Warning&) const = default;
};

/// A finding of the diagnosis of a run: a number beyond the threshold of a rule (scenarios/run/diagnosis.hpp).
struct Diagnosed {
  /// rule: name of the rule. number, unit: name and unit of the number that the rule compares; "1": pure number.
  std::string rule, number, unit;
  double value = 0.0, threshold = 0.0;
  std::string says, attempt;  ///< says: what is wrong with the run. attempt: what to change
};

/// Wall times of a run.
struct RunTiming {
  double shell = 0.0;                  ///< time to compute or load the environment's point shell [s]
  double loop = 0.0;                   ///< time of the step loop, including observers [s]
  std::optional<StepLatency> latency;  ///< times of single steps, including observers; empty if not measured
  /// Median and 99th percentile of the time of a step, excluding observers and recorders [s] (StepSampler). Both are
  /// empty without steps; the 99th percentile is empty for fewer than 100 steps.
  std::optional<double> step_p50 = {}, step_p99 = {};
  std::uint64_t preemptions = 0;  ///< involuntary context switches during the step loop
};

/// End of a run and its outcome.
struct RunEnd {
  Outcome outcome = Outcome::completes;
  std::uint64_t rows = 0;  ///< number of observed steps
  Divergence divergence;   ///< valid if the outcome is `diverges`
  /// Time at which a run of a batch (RunLength::until_failure) ended early, after a final failure (FinalFailure in
  /// scenarios/run/outcome.hpp) or a divergence [s]. No metric of such a run has a value. Empty for all other runs.
  std::optional<double> ended_at = {};
};

/// The result of a run, or of all trials of a tracking hand.
struct Result {
  std::string name;       ///< name of the scenario
  std::string algorithm;  ///< registered name of the algorithm
  /// End of the run. After several trials: the worst outcome, and the number of steps of all trials together.
  RunEnd end;
  bool expected = false;           ///< true if the run met all expectations of the scenario
  std::vector<std::string> unmet;  ///< expectations that the run did not meet
  double duration = 0.0;           ///< simulated time: number of steps times dt [s]
  /// All metrics, in the order of the columns of a sweep's table. A scenario's `expect` can bound each metric. The
  /// order is: the metrics of every run, without a prefix in the name; then the coordinates of the final position, such
  /// as "final_position_m.x"; then the metrics of the sections, such as "energy.created_sum_J" or
  /// "targets.0.success_rate.mean".
  MetricList metrics;
  /// The sections of summary.json: passivity, and the sections that the scenario requests. Each section is a JSON
  /// object that has only the members that are not metrics, such as the events of the section energy.
  nlohmann::ordered_json sections;
  std::uint64_t state_hash = 0;  ///< MetricsObserver::state_hash
  nlohmann::ordered_json tool;   ///< tool_json of a tool that is not a cylinder; null for a cylinder
  /// Warnings about the scenario's files, followed by warnings about the run.
  std::vector<Warning> warnings;
  std::optional<std::vector<Diagnosed>> diagnosis;  ///< empty if the diagnosis was not requested
  /// Rules of the diagnosis for low vibration with their numbers, also below the thresholds; empty if not requested.
  std::vector<Diagnosed> low_vibration;
  RunWork work;
  std::vector<TargetRow> targets;  ///< targets of all subjects and trials of a tracking hand
  RunTiming timing;
  Provenance provenance;
  std::string scenario_hash;    ///< hash of the effective scenario
  bool replaces_other = false;  ///< true if the output directory contained results of another scenario
};

/// Returns summary.json. The same run gives the same bytes: no time stamps, no timings, no instruction set. Numbers
/// that do not exist (a ratio without contact, the final position without steps) or are not finite are null.
nlohmann::ordered_json summary_json(const Result& run);

/// Returns the shape of a tool for drawings: half width, reach (distance from the tip centre to the farthest point),
/// convexity and outline; lengths in metres. The scenario's fields do not contain this shape.
nlohmann::ordered_json tool_json(const ToolShape& tool);

/// Returns a latency distribution for timing.json, in seconds; percentiles and maximum are null without steps.
nlohmann::ordered_json step_latency_json(const StepLatency& latency);

/// Returns timing.json. It is separate from summary.json because no two runs take the same time. It contains the
/// build's instruction set and the CPU, on which the times depend. The mean time of a step is null without steps. The
/// latency is null if steps were not timed.
std::string timing_text(const Result& run);

}  // namespace hapbench
