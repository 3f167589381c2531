#include "scenarios/run/bare_run.hpp"

#include <ctime>
#include <utility>

#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

BareRun::BareRun(CheckedScenario checked, const std::shared_ptr<const PointShell>& shell)
    : checked_(std::move(checked)),
      simulation_(simulation_config(checked_.scenario()),
                  assemble(checked_.scenario(), checked_.files(), shell, Trial{}), {}) {}

double BareRun::seconds(std::uint64_t times) {
  const double before = processor_seconds();
  for (std::uint64_t i = 0; i < times; ++i) {
    simulation_.reset();
    run_to_end(simulation_);
  }
  return (processor_seconds() - before) / static_cast<double>(times);
}

StepLatency BareRun::latency() {
  StepTimes times(static_cast<std::size_t>(checked_.scenario().time.steps));
  simulation_.reset();
  times.start();
  run_to_end(simulation_, [&] {
    bool more = true;
    for (std::uint64_t i = 0; i < kStepsPerStopCheck && (more = simulation_.step()); ++i) times.lap();
    times.start();  // the check for a signal is no part of a step
    return more;
  });
  return step_latency(times.nanoseconds(), times.overhead());
}

}  // namespace hapbench
