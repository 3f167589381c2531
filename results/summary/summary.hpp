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

/// Counted work of a run. Counts are exact and repeatable; times are in timing.json.
struct RunWork {
  SearchWork search;
  std::uint64_t steps_skipped = 0;  ///< steps without any contact search
  AlgorithmWork algorithm;
  std::uint64_t allocations = 0;  ///< on the heap, inside the step loop

  RunWork& operator+=(const RunWork& other) noexcept {
    search += other.search;
    steps_skipped += other.steps_skipped;
    algorithm += other.algorithm;
    allocations += other.allocations;
    return *this;
  }
};

/// Something that may make the numbers of a run mislead; nothing is refused for it.
struct Warning {
  std::string kind;     ///< what it is, in a word: the same for the same reason, whatever numbers the text has
  std::string pointer;  ///< JSON pointer of the field that it is about; empty when it is about the run
  std::string text;     ///< a sentence

  /// As results keep it, equal wherever the files lie.
  std::string told() const { return pointer.empty() ? text : pointer + ": " + text; }

  bool operator==(const Warning&) const = default;
};

/// Something wrong with a run: a number beyond the threshold of a rule (scenarios/run/diagnosis.hpp).
struct Diagnosed {
  std::string rule, number, unit;  ///< names of the rule and of its number; "1" for pure numbers
  double value = 0.0, threshold = 0.0;
  std::string says, attempt;  ///< what is wrong, and what to try
};

/// Wall times of a run.
struct RunTiming {
  double shell = 0.0;                  ///< to make or fetch the environment's points [s]
  double loop = 0.0;                   ///< of the step loop, observers included [s]
  std::optional<StepLatency> latency;  ///< of single steps, observers included; nothing when they were not timed
  /// Median and 99th percentile of the time of a step by itself, without observers and recorders [s] (StepSampler);
  /// nothing without steps, and no 99th percentile of fewer than a hundred.
  std::optional<double> step_p50 = {}, step_p99 = {};
  std::uint64_t preemptions = 0;  ///< involuntary context switches during the step loop
};

/// The end of a run, judged.
struct RunEnd {
  Outcome outcome = Outcome::completes;
  std::uint64_t rows = 0;  ///< rows observed
  Divergence divergence;   ///< if the outcome is `diverges`
};

/// The result of a run, or of all trials of a tracking hand.
struct Result {
  std::string name;                ///< of the scenario
  std::string algorithm;           ///< as registered
  RunEnd end;                      ///< of several trials the worst, with the rows of all
  bool expected = false;           ///< the run met all that the scenario expects
  std::vector<std::string> unmet;  ///< expectations that it did not meet
  double duration = 0.0;           ///< simulated time: rows x dt [s]
  /// The numbers that a scenario's `expect` may bound and the table of a sweep holds, in this order: those of every run
  /// under their own names, the final position's coordinates, as "final_position_m.x", then those of the sections, as
  /// "energy.created_sum_J" or "targets.0.success_rate.mean".
  MetricList metrics;
  /// The sections, passivity and others for which the scenario asks, each with an object of what is not a metric, such
  /// as the events of the energy; null without sections.
  nlohmann::ordered_json sections;
  std::uint64_t state_hash = 0;                     ///< MetricsObserver::state_hash
  nlohmann::ordered_json tool;                      ///< tool_json of a tool that is not a cylinder; else null
  std::vector<Warning> warnings;                    ///< about the files that the scenario names, then about the run
  std::optional<std::vector<Diagnosed>> diagnosis;  ///< of a run that asked for it
  RunWork work;
  std::vector<TargetRow> targets;  ///< of a tracking hand, all subjects and trials
  RunTiming timing;
  Provenance provenance;
  std::string scenario_hash;    ///< of the effective scenario
  bool replaces_other = false;  ///< its directory had the results of another scenario
};

/// summary.json. The same run gives the same bytes: no time stamps, no timings, no instruction set. Numbers that do not
/// exist (a ratio without contact, the final position without rows) or are not finite are null.
nlohmann::ordered_json summary_json(const Result& run);

/// Shape of a tool that the scenario's fields do not show, for drawings: half width, reach and outline [m].
nlohmann::ordered_json tool_json(const ToolShape& tool);

/// A distribution for timing.json, in seconds; percentiles and maximum are null without steps.
nlohmann::ordered_json step_latency_json(const StepLatency& latency);

/// timing.json, separate from summary.json because no two runs take the same time. Names the build's instruction set
/// and the CPU, which make times comparable. The mean is null without steps, the latency when steps were not timed.
std::string timing_text(const Result& run);

}  // namespace hapbench
