#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/jobs.hpp"

/// Sends random contact situations (stress_set.hpp) through all algorithms and counts where a force is not finite or
/// exceeds its bound.
namespace hapbench {

/// The counts of one algorithm over all sets.
struct StressCounts {
  std::string algorithm;
  std::uint64_t sets = 0;            ///< drawn
  std::uint64_t in_contact = 0;      ///< whose tool touches a point
  std::uint64_t non_finite = 0;      ///< force, tensor or depth not finite
  std::uint64_t out_of_bound = 0;    ///< finite, but beyond a bound
  std::uint64_t points_dropped = 0;  ///< by a full reduction
  double largest_force = 0.0;        ///< largest |f_spring| in units of K d, d the deepest point of the set
  /// Largest |f_spring| in units of its bound (AlgorithmEntry::force_bound); none for algorithms without one.
  std::optional<double> largest_share;
  std::optional<std::uint64_t> first_bad;  ///< number of the first set that is not finite or out of bound
};

/// Sends sets 0 … count - 1 of the seed through every algorithm of the registry; one entry each, in its order. The same
/// counts whatever the number of threads. About 2.5 us a set and algorithm.
std::vector<StressCounts> stress_laws(std::uint64_t count, std::uint64_t seed, const JobOptions& options);

}  // namespace hapbench
