#include <cstdio>
#include <exception>
#include <string_view>

#include "tests/bench/bench.hpp"
#include "tests/bench/table.hpp"

namespace hapbench::bench {
namespace {

bool refuted = false;

int run_benchmarks(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const auto register_group : {register_search, register_shaping, register_reduction, register_laws,
                                    register_proxy, register_steps, register_shells, register_skips}) {
    register_group();
  }
  // No benchmark of a given filter is a mistake in the filter.
  if (benchmark::RunSpecifiedBenchmarks() == 0) return 2;
  return refuted ? 1 : 0;
}

}  // namespace

void refute(benchmark::State& state, const std::string& what) {
  refuted = true;
  state.SkipWithError(what.c_str());
}

}  // namespace hapbench::bench

/// `hapbench_bench [--benchmark_…]` runs the benchmarks, `hapbench_bench --table` measures the targets.
int main(int argc, char** argv) {
  try {
    if (argc == 2 && std::string_view(argv[1]) == "--table") return hapbench::bench::print_table();
    return hapbench::bench::run_benchmarks(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hapbench_bench: %s\n", error.what());
    return 1;
  }
}
