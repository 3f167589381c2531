#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/jobs.hpp"

/// Stress test: computes the force of all algorithms for random contact sets (stress_set.hpp), and counts forces that
/// are not finite or exceed their bound.
namespace hapbench {

/// The counts of one algorithm over all sets.
struct StressCounts {
  std::string algorithm;
  std::uint64_t sets = 0;            ///< number of sets
  std::uint64_t in_contact = 0;      ///< sets with at least one contact
  std::uint64_t non_finite = 0;      ///< sets with a force, tensor or depth that is not finite
  std::uint64_t out_of_bound = 0;    ///< sets whose results are finite, and at least one result exceeds its bound
  std::uint64_t points_dropped = 0;  ///< points that the contact reduction dropped when it was full
  double largest_force = 0.0;        ///< largest |f_spring| / (K d) over all sets, with the largest depth d of each set
  /// Largest ratio of |f_spring| to its bound (AlgorithmEntry::force_bound); empty for algorithms without a bound.
  std::optional<double> largest_share;
  std::optional<std::uint64_t> first_bad;  ///< index of the first set that is not finite or out of bound
};

/// Computes the forces for the contact sets stress_set(seed, 0) … stress_set(seed, count - 1) with every algorithm.
/// Returns the counts of each algorithm, in the order of the registry. The counts do not depend on the number of
/// threads. Takes about 2.5 us for each set and algorithm.
std::vector<StressCounts> stress_laws(std::uint64_t count, std::uint64_t seed, const JobOptions& options);

}  // namespace hapbench
