#include <fmt/format.h>

#include <algorithm>

#include "results/observe/step_times.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/step.hpp"

/// Single steps against the deadlines of a haptic loop. The same run several times takes the same steps, so what is
/// slow in every one is the program's doing and what is slow in one is the machine's.
namespace hapbench::bench {
namespace {

constexpr benchmark::IterationCount kRuns = 5;

void latency(benchmark::State& state, const std::string& name) {
  if (!proved(state, "step/" + name, [&name] { return wrong_run(name); })) return;
  TimedRun run(name);
  std::vector<std::uint64_t> all, best;
  for (auto _ : state) {
    StepTimes times(run.steps_left());
    run.rewind();
    times.start();
    while (run.simulation().step()) times.lap();
    const auto ns = times.nanoseconds();
    all.insert(all.end(), ns.begin(), ns.end());
    if (best.empty()) best.assign(ns.begin(), ns.end());
    for (std::size_t k = 0; k < ns.size(); ++k) best[k] = std::min(best[k], ns[k]);
  }
  const StepLatency single = step_latency(all, 0), repeatable = step_latency(best, 0);
  state.counters["p50_s"] = 1e-9 * static_cast<double>(single.p50);
  state.counters["p99_9_s"] = 1e-9 * static_cast<double>(repeatable.p99_9);
  state.counters["longest_s"] = 1e-9 * static_cast<double>(repeatable.max);
  state.counters["steps"] = static_cast<double>(repeatable.steps);
  state.counters["late"] = static_cast<double>(repeatable.misses[1]);
}

}  // namespace

void register_latencies() {
  for (const char* name : {"T1", "T2", "T2_proxy", "T3", "unreduced_1000", "upright_proxy"}) {
    benchmark::RegisterBenchmark(fmt::format("latency/{}", name).c_str(), latency, std::string(name))
        ->Iterations(kRuns)
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace hapbench::bench
