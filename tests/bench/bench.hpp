#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>

#include "sim/contact/contact_buffer.hpp"

/// The groups of benchmarks. Their names are part of the interface, because scripts and people compare them from commit
/// to commit.
namespace hapbench::bench {

/// law/<algorithm>/{50,250,1000}, reduction/{50,250,1000}, growth/{law/<algorithm>,reduction}/<contacts>
void register_laws();
/// step/<one of kSteps>, latency/<step>: counters of single steps, skip/<what>/{taken,off}, growth/step/<contacts>
void register_steps();
/// search/{brute_force,neighbour_list}/{T1,T2,T3}, shell/build, growth/{shell,search/<search>,list_rebuild}/<shell
/// points>; if `full` also for shells that take minutes
void register_searches(bool full);

/// Ends a benchmark whose answer is wrong, and the program with status 1.
void refute(benchmark::State& state, const std::string& what);

/// For long proofs: calls `wrong` once per process and benchmark. It returns what is wrong with the answer, or nothing.
/// Refutes the benchmark if something is wrong. Returns true if the answer is right.
bool proved(benchmark::State& state, const std::string& benchmark, const std::function<std::string()>& wrong);

/// Numbers of contacts over which growth is measured.
inline constexpr std::size_t kGrowthContacts[] = {10, 100, 1000, 10'000, 100'000};

/// n contacts with depths and gradients before the reduction, from poses of T2 a tenth of a second apart, at most about
/// 2000. Padded.
ContactBuffer task_contacts(std::size_t n);

}  // namespace hapbench::bench
