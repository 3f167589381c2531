#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

#include "sim/contact/contact_buffer.hpp"

/// The groups of benchmarks. Their names are part of the interface, because scripts and people compare them from commit
/// to commit.
namespace hapbench::bench {

void register_search();            ///< search/{brute_force,grid,neighbour_list}/{T1,T2,T3}
void register_shaping();           ///< shaping/{matrix,tensor,exact}/{10,50,250,1000}
void register_reduction();         ///< reduction/{50,250,1000,T3}, largest_depth/T3
void register_laws();              ///< law/<algorithm>/{50,250,1000}
void register_proxy();             ///< proxy/solve/T2
void register_steps();             ///< step/<one of kSteps>, in step.cpp
void register_latencies();         ///< latency/<step>: counters of single steps
void register_ideal_trajectory();  ///< ideal_trajectory/row, inside/row/{free,pressed}
void register_shells();            ///< shell/build
void register_skips();             ///< skip/<what>/{taken,off}

// Growth of the cost. growth/{law/<algorithm>,reduction}/<contacts> are registered with their groups.
void register_growth_over_contacts();         ///< growth/step/<contacts>
void register_growth_over_points(bool full);  ///< growth/{shell,search/<search>,list_rebuild}/<shell points>, if `full`
                                              ///< also for shells that take minutes

/// Ends a benchmark whose answer is wrong, and the program with status 1. Every benchmark proves its answer before it
/// is timed.
void refute(benchmark::State& state, const std::string& what);

/// For long proofs: calls `wrong` once per process and benchmark. It returns what is wrong with the answer, or nothing.
/// Refutes the benchmark if something is wrong. Returns true if the answer is right.
bool proved(benchmark::State& state, const std::string& benchmark, const std::function<std::string()>& wrong);

/// Numbers of contacts over which growth is measured.
inline constexpr std::size_t kGrowthContacts[] = {10, 100, 1000, 10'000, 100'000};

/// n contacts with depths and gradients before the reduction, from poses of T2 a tenth of a second apart, at most about
/// 2000. Padded.
ContactBuffer task_contacts(std::size_t n);
/// n contacts for any n; beyond kRepeated, they repeat. The force of many then follows from that of a thousand.
inline constexpr std::size_t kRepeated = 1000;
ContactBuffer repeated_contacts(std::size_t n);

/// The contacts of every 64th pose of a task before the reduction. Padded.
std::vector<ContactBuffer> contacts_along(const std::string& task);

}  // namespace hapbench::bench
