#include <chrono>
#include <limits>

#include "tests/bench/accuracy/accuracy.hpp"
#include "tests/bench/benchmark_program.hpp"
#include "tests/scenarios/support/bundled.hpp"

namespace hapbench::accuracy {
namespace {

/// Measures the run time of a setting as the shortest of all runs, and adds the setting's errors as counters.
void measure(benchmark::State& state, const Setting& setting, const Errors& errors) {
  using Clock = std::chrono::steady_clock;
  const Work work = setting.work();
  double smallest = std::numeric_limits<double>::infinity();
  for (auto _ : state) {
    if (work.prepare) work.prepare();
    const auto start = Clock::now();
    work.run();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    smallest = std::min(smallest, seconds);
    state.SetIterationTime(seconds);
  }
  state.SetLabel(errors.outcome);
  state.counters["seconds_per_" + setting.unit] = smallest / static_cast<double>(work.count);
  for (const auto& [name, value] : errors.values)
    if (value) state.counters[name] = *value;
}

void add(const Panel& panel) {
  for (const Setting& setting : panel) {
    benchmark::RegisterBenchmark(setting.name.c_str(), [setting,
                                                        errors = once(setting.errors)](benchmark::State& state) {
      measure(state, setting, errors());
    })->UseManualTime();
  }
}

void add_panels() {
  using test::bundled;
  const Scenario drill = bundled("rotate_in_hole"), molar = bundled("drag_molar");
  add(integrators(bundled("springs_oscillation")));
  for (const auto panel : {algorithms, spacing, shaping, reduction, merging}) add(panel(drill));
  for (const auto panel : {multi_rate_contacts, skips}) add(panel(molar));
  add(events(bundled("bounce_plane")));
}

}  // namespace
}  // namespace hapbench::accuracy

/// `hapbench_accuracy [--benchmark_…]` measures run time against error.
int main(int argc, char** argv) {
  return hapbench::bench::run_benchmarks("hapbench_accuracy", argc, argv, hapbench::accuracy::add_panels);
}
