#pragma once

#include <benchmark/benchmark.h>

#include "tests/bench/task_scene.hpp"

namespace hapbench::bench {

/// Times how a scenario's shell is built, once it has been held against the block's exact surface and against `again`,
/// the same shell built before. Counters: points, and bytes_per_point, by how much the process grew at most.
void build_shells(benchmark::State& state, const Scenario& scenario, const PointShell& again);

}  // namespace hapbench::bench
