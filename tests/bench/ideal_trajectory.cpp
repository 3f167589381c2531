#include <algorithm>
#include <cmath>

#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/inside_observer.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/task_scene.hpp"

/// The cost of a row of ideal_trajectory.csv: the ideal place of the tip and the true depth of the tool in the block.
namespace hapbench::bench {
namespace {

constexpr std::size_t kPosesApart = 16;  ///< poses of T2

struct Scene {
  const TaskScene& task = task_scene("T2");
  const BlockWithHole block = std::get<BlockEnvironment>(task.loaded.scenario.environment).block;
  const Cylinder tool = make_cylinder(task.loaded.scenario.tool);
};

void row(benchmark::State& state) {
  const Scene scene;
  const auto& poses = scene.task.poses;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(poses.size() / kPosesApart))) {
    for (std::size_t k = 0; k < poses.size(); k += kPosesApart) {
      benchmark::DoNotOptimize(ideal_place(scene.block, scene.tool.radius(), std::acos(-poses[k].axis.z())));
      benchmark::DoNotOptimize(interpenetration(scene.block, scene.tool, poses[k]));
    }
  }
}

/// A row of the observer of how deep the tool is, while the tip slides to and fro at this height over the block.
void inside_row(benchmark::State& state, double height) {
  const Scene scene;
  InsideObserver observer(std::make_shared<const Cylinder>(scene.tool), make_solid(scene.block));
  StepRecord record;
  const double depth = std::max(0.0, -height);
  for (auto _ : state) {
    record.tool.pose.position = {0.004 + 1e-6 * static_cast<double>(++record.step % 512), 0.0, height};
    record.force.depth_max = depth;
    observer.on_step(record);
  }
  const double found = observer.depths().max.value_or(-1.0);
  if (std::abs(found - depth) > InsideSearch::kTolerance * (depth + scene.tool.radius())) refute(state, "wrong depth");
}

}  // namespace

void register_ideal_trajectory() {
  benchmark::RegisterBenchmark("ideal_trajectory/row", row);
  benchmark::RegisterBenchmark("inside/row/free", inside_row, 0.002);
  benchmark::RegisterBenchmark("inside/row/pressed", inside_row, -0.0001);
}

}  // namespace hapbench::bench
