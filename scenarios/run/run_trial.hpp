#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "results/observe/step_times.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/recorders.hpp"

namespace hapbench {

/// What one trial of a scenario came to; most scenarios have one.
struct TrialResult {
  SimulationResult result;
  std::shared_ptr<const ToolShape> tool;
  Metrics metrics;
  std::optional<PassivityMetrics> passivity;
  std::optional<SectionObservers> sections;  ///< never empty in what run_trial returns
  std::vector<std::string> warnings;         ///< what may make the numbers mislead
  RunWork work;
  double loop_seconds = 0.0;                    ///< wall time of the step loop
  std::vector<std::uint64_t> step_nanoseconds;  ///< samples of what steps take by themselves (StepSampler)
  std::uint64_t preemptions = 0;                ///< involuntary context switches in the loop
  /// Of what was recorded: files are complete but under temporary names until `finish`.
  std::vector<std::unique_ptr<Recorder>> recorders;
};

/// How a trial runs, beside what its scenario says.
struct TrialOptions {
  std::optional<RecordTarget> target;  ///< of what the scenario records; a directory exists
  std::string label;                   ///< of the progress bar; none when empty
  StepTimes* times = nullptr;          ///< when not null, every step is timed into it
  std::optional<NamedFiles> files;     ///< of the scenario; read when not given
};

/// Runs one trial. `shell` is make_shell of the scenario. Throws InputError for files it cannot use and IoError when a
/// record cannot be written, Stopped when a signal ends it (run_to_end.hpp).
TrialResult run_trial(const Scenario& scenario, std::shared_ptr<const PointShell> shell, Trial trial,
                      const TrialOptions& options);

}  // namespace hapbench
