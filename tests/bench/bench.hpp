#pragma once

#include <benchmark/benchmark.h>

#include <string>

/// The benchmarks, a group in a file each. Their names are part of the interface: scripts and people compare them from
/// commit to commit.
namespace hapbench::bench {

void register_search();     ///< search/{brute_force,grid,neighbour_list}/{T1,T2,T3}
void register_shaping();    ///< shaping/{matrix,tensor,exact}/{10,50,250,1000}
void register_reduction();  ///< reduction/{50,250,1000}
void register_laws();       ///< law/<algorithm>/{50,250,1000}
void register_proxy();      ///< proxy/solve/T2
void register_steps();      ///< step/{T1,T2,T2_proxy,T3,unreduced_1000,free_air}
void register_shells();     ///< shell/build
void register_skips();      ///< skip/<what>/{taken,off}

/// Every benchmark proves its answer before it is timed. One that cannot is ended by this, and the program with it by
/// status 1.
void refute(benchmark::State& state, const std::string& what);

}  // namespace hapbench::bench
