#include "tests/bench/shell.hpp"

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "tests/bench/bench.hpp"

namespace hapbench::bench {
namespace {

bool same_points(const PointShell& a, const PointShell& b) {
  if (a.size() != b.size()) return false;
  for (const auto column :
       {&PointShell::x, &PointShell::y, &PointShell::z, &PointShell::nx, &PointShell::ny, &PointShell::nz}) {
    if (!std::equal((a.*column)(), (a.*column)() + a.size(), (b.*column)())) return false;
  }
  return true;
}

/// A line of /proc/self/status [bytes]; 0 where there is none.
double memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kB = 0.0;
    if (word == key + ":" && status >> kB) return 1024.0 * kB;
  }
  return 0.0;
}

/// By how much the process has to grow to build the shell [bytes].
double memory_of_building(const Scenario& scenario) {
  malloc_trim(0);                               // what lies free counts as not there …
  std::ofstream("/proc/self/clear_refs") << 5;  // … and the peak is that from here on
  const double before = memory("VmRSS");
  benchmark::DoNotOptimize(built_shell(scenario));
  return memory("VmHWM") - before;
}

void build(benchmark::State& state) {
  build_shells(state, step_scenario("T1").scenario, *block_shell());
}

}  // namespace

void build_shells(benchmark::State& state, const Scenario& scenario, const PointShell& again) {
  // Marching cubes has its own proof (against scikit-image). A vertex lies on an edge that crosses the surface, so it
  // is no further from it than the edge is long.
  const auto& block = std::get<BlockEnvironment>(scenario.environment);
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (std::abs(signed_distance(block.block, again.point(i).position)) > block.grid) {
      return refute(state, "off the surface");
    }
  }
  const double bytes = memory_of_building(scenario);
  std::shared_ptr<const PointShell> shell;
  for (auto _ : state) {
    shell.reset();
    shell = built_shell(scenario);
  }
  if (!same_points(*shell, again)) return refute(state, "another shell the second time");
  state.counters["points"] = static_cast<double>(shell->size());
  state.counters["bytes_per_point"] = bytes / static_cast<double>(shell->size());
}

void register_shells() {
  benchmark::RegisterBenchmark("shell/build", build)->Unit(benchmark::kMillisecond);
}

}  // namespace hapbench::bench
