#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>

/// The benchmarks, a group in a file each. Their names are part of the interface: scripts and people compare them from
/// commit to commit.
namespace hapbench::bench {

void register_search();            ///< search/{brute_force,grid,neighbour_list}/{T1,T2,T3}
void register_shaping();           ///< shaping/{matrix,tensor,exact}/{10,50,250,1000}
void register_reduction();         ///< reduction/{50,250,1000,T3}, largest_depth/T3
void register_laws();              ///< law/<algorithm>/{50,250,1000}
void register_proxy();             ///< proxy/solve/T2
void register_steps();             ///< step/<one of kSteps>
void register_latencies();         ///< latency/<some of kSteps>: counters of single steps, not their mean
void register_ideal_trajectory();  ///< ideal_trajectory/row
void register_shells();            ///< shell/build
void register_skips();             ///< skip/<what>/{taken,off}

/// How cost grows: growth/{law/<algorithm>,reduction}/<contacts> are registered with their groups.
void register_growth_over_contacts();         ///< growth/step/<contacts>
void register_growth_over_points(bool full);  ///< growth/{shell,search/<search>,list_rebuild}/<shell points>, if `full`
                                              ///< also for shells that take minutes

/// Every benchmark proves its answer before it is timed. One that cannot is ended by this, and the program with it by
/// status 1.
void refute(benchmark::State& state, const std::string& what);

/// For proofs that take long: asks `wrong` what is wrong with the answer, once in a process however often the benchmark
/// is repeated, and refutes the benchmark unless that is nothing. Returns whether the answer is right.
bool proved(benchmark::State& state, const std::string& benchmark, const std::function<std::string()>& wrong);

}  // namespace hapbench::bench
