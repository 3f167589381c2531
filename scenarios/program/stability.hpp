#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/program/command.hpp"

/// The experiments of `hapbench stability`; the limits of A.3 are in stability.cpp itself.
namespace hapbench {

struct StabilityOptions {
  std::vector<std::string> scenarios;
  std::vector<std::string> maps;
  bool stress = false;
  bool search = false;
  std::vector<std::string> algorithms;   ///< none: all
  std::vector<std::string> integrators;  ///< none: leapfrog
  std::size_t size = 17;
  std::uint64_t count = 100'000;
  std::string objective = "created";
  std::uint64_t evaluations = 400;
  std::uint64_t seed = 1;
  unsigned jobs = 0;  ///< 0: as many as the machine has
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;

  /// The algorithms asked for, all of them without --algorithms.
  std::vector<std::string> chosen_algorithms() const;
  /// --out, or results/out/`name`.
  std::filesystem::path directory(const std::string& name) const;
  /// Threads, and a progress bar with `label` unless --quiet.
  JobOptions job_options(const std::string& label) const;
};

int stability_maps_command(const StabilityOptions& options);
int stability_stress_command(const StabilityOptions& options);
int stability_search_command(const StabilityOptions& options);

}  // namespace hapbench
