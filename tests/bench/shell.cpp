#include <cmath>
#include <cstring>

#include "scenarios/run/environment_points.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/task_scene.hpp"

namespace hapbench::bench {
namespace {

using Points = std::vector<SurfacePoint>;

bool same_bytes(const Points& a, const Points& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(SurfacePoint)) == 0;
}

void build(benchmark::State& state) {
  const Scenario& scenario = step_scenario("T1").scenario;
  const auto built = [&scenario] { return environment_points(scenario).points; };
  const Points points = built();
  // Marching cubes has its own proof (against scikit-image). A vertex lies on an edge that crosses the surface, so it
  // is no further from it than the edge is long.
  const auto& block = std::get<BlockEnvironment>(scenario.environment);
  for (const SurfacePoint& point : points) {
    if (std::abs(signed_distance(block.block, point.position)) > block.grid) return refute(state, "off the surface");
  }
  if (!same_bytes(points, built())) return refute(state, "another shell the second time");
  for (auto _ : state) benchmark::DoNotOptimize(built());
  state.counters["points"] = static_cast<double>(points.size());
}

}  // namespace

void register_shells() {
  benchmark::RegisterBenchmark("shell/build", build)->Unit(benchmark::kMillisecond);
}

}  // namespace hapbench::bench
