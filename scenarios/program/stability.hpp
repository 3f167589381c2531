#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/program/command.hpp"

/// The experiments of `hapbench stability`: limits of A.3 and stress test in stability.cpp, maps in
/// stability_map.cpp.
namespace hapbench {

struct StabilityOptions {
  std::vector<std::string> scenarios;
  std::vector<std::string> maps;
  bool stress = false;
  std::vector<std::string> algorithms;   ///< empty: all
  std::vector<std::string> integrators;  ///< empty: leapfrog
  std::size_t size = 17;
  std::uint64_t count = 100'000;
  std::uint64_t seed = 1;
  unsigned jobs = 0;  ///< 0: as many as the machine has
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;

  /// The algorithms given, or all.
  std::vector<std::string> chosen_algorithms() const;
  /// Threads, and a progress bar with `label` unless --quiet.
  JobOptions job_options(const std::string& label) const;
};

/// Draws, prints and writes the maps. Returns the exit status.
int stability_maps_command(const StabilityOptions& options);

}  // namespace hapbench
