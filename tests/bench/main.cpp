#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <string_view>

#include "results/summary/provenance.hpp"
#include "tests/bench/bench.hpp"

namespace hapbench::bench {
namespace {

bool refuted = false;

/// Adds the commit and the machine to the output; --benchmark_format=json has them under "context".
void add_context() {
  const Provenance program = provenance();
  const InstructionSet instructions = instruction_set();
  benchmark::AddCustomContext("commit", program.commit);
  benchmark::AddCustomContext("cpu", program.cpu);
  benchmark::AddCustomContext("compiler", program.compiler);
  benchmark::AddCustomContext("flags", program.build_type + " " + program.flags);
  benchmark::AddCustomContext("instruction_set", instructions.widest);
}

/// Removes our option --full from the arguments and returns whether it was there.
bool take_full(int& argc, char** argv) {
  char** const end =
      std::remove_if(argv + 1, argv + argc, [](const char* a) { return std::string_view(a) == "--full"; });
  const bool full = end != argv + argc;
  argc = static_cast<int>(end - argv);
  return full;
}

int run_benchmarks(int argc, char** argv) {
  const bool full = take_full(argc, argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add_context();
  for (const auto register_group : {register_search, register_shaping, register_reduction, register_laws,
                                    register_proxy, register_steps, register_latencies, register_ideal_trajectory,
                                    register_shells, register_skips, register_growth_over_contacts}) {
    register_group();
  }
  register_growth_over_points(full);
  // A filter that matches nothing is a mistake.
  if (benchmark::RunSpecifiedBenchmarks() == 0) return 2;
  return refuted ? 1 : 0;
}

}  // namespace

void refute(benchmark::State& state, const std::string& what) {
  refuted = true;
  state.SkipWithError(what.c_str());
}

bool proved(benchmark::State& state, const std::string& benchmark, const std::function<std::string()>& wrong) {
  static std::map<std::string, std::string> known;
  auto found = known.find(benchmark);
  if (found == known.end()) found = known.emplace(benchmark, wrong()).first;
  if (!found->second.empty()) refute(state, found->second);
  return found->second.empty();
}

}  // namespace hapbench::bench

/// `hapbench_bench [--full] [--benchmark_…]` runs the benchmarks.
int main(int argc, char** argv) {
  try {
    return hapbench::bench::run_benchmarks(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hapbench_bench: %s\n", error.what());
    return 1;
  }
}
