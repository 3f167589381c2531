#include <algorithm>
#include <map>
#include <string_view>

#include "tests/bench/bench.hpp"
#include "tests/bench/benchmark_program.hpp"

namespace hapbench::bench {
namespace {

bool refuted = false;

/// Removes the option --full of this program from the arguments. Returns true if it was present.
bool take_full(int& argc, char** argv) {
  char** const end =
      std::remove_if(argv + 1, argv + argc, [](const char* a) { return std::string_view(a) == "--full"; });
  const bool full = end != argv + argc;
  argc = static_cast<int>(end - argv);
  return full;
}

void add_benchmarks(bool full) {
  register_laws();
  register_steps();
  register_searches(full);
}

int run(int argc, char** argv) {
  const bool full = take_full(argc, argv);
  const int status = run_benchmarks("hapbench_bench", argc, argv, [full] { add_benchmarks(full); });
  return status == 0 && refuted ? 1 : status;
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
  return hapbench::bench::run(argc, argv);
}
