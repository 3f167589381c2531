#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "results/observe/step_times.hpp"
#include "results/summary/provenance.hpp"

namespace hapbench {

/// Wall times of a run.
struct RunTiming {
  double shell = 0.0;                  ///< to make or fetch the environment's points [s]
  double loop = 0.0;                   ///< of the step loop, observers included [s]
  std::uint64_t steps = 0;             ///< rows computed in that time
  std::optional<StepLatency> latency;  ///< of single steps, observers included; nothing when they were not timed
  /// Median and 99th percentile of the time of a step by itself, without observers and recorders [s] (StepSampler);
  /// nothing without steps, and no 99th percentile of fewer than a hundred.
  std::optional<double> step_p50 = {}, step_p99 = {};
  std::uint64_t preemptions = 0;  ///< involuntary context switches during the step loop
};

/// A distribution for timing.json, in seconds; percentiles and maximum are null without steps.
nlohmann::ordered_json step_latency_json(const StepLatency& latency);

/// timing.json, separate from summary.json because no two runs take the same time. It names the build's instruction set
/// and the CPU: times are comparable only for equal ones. The mean is null without steps, the latency when steps were
/// not timed.
nlohmann::ordered_json timing_json(const RunTiming& timing, const InstructionSet& instructions,
                                   const Provenance& provenance);
std::string timing_text(const RunTiming& timing, const InstructionSet& instructions, const Provenance& provenance);

}  // namespace hapbench
