#pragma once

#include <benchmark/benchmark.h>

#include <cstdio>
#include <exception>

#include "results/summary/summary.hpp"

namespace hapbench::bench {

/// The main function of a Google Benchmark program. Runs the benchmarks that `add` registers, and writes the commit and
/// the machine into "context" of --benchmark_format=json. Returns the exit status: 2 if an argument is unknown or the
/// filter matches no benchmark, 1 after an exception, otherwise 0.
template <class Add>
int run_benchmarks(const char* program, int argc, char** argv, Add add) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    const Provenance made_by = provenance();
    benchmark::AddCustomContext("commit", made_by.commit);
    benchmark::AddCustomContext("cpu", made_by.cpu);
    benchmark::AddCustomContext("compiler", made_by.compiler);
    benchmark::AddCustomContext("flags", made_by.build_type + " " + made_by.flags);
    benchmark::AddCustomContext("instruction_set", made_by.widest);
    add();
    return benchmark::RunSpecifiedBenchmarks() == 0 ? 2 : 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

}  // namespace hapbench::bench
