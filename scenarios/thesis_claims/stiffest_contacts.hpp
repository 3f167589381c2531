#pragma once

#include <cstddef>

namespace hapbench {

/// Instead of a number of iterations: the exact limit.
inline constexpr int kExactLimit = -1;

/// Rounding may lift a result of the search above the true supremum by this much.
inline constexpr double kSearchRounding = 1e-9;

/// Result of a search for contacts that stiffness shaping makes stiff.
struct StiffestContacts {
  double lambda_max = 0.0;  ///< largest eigenvalue of S, in units of K
  std::size_t sets = 0;     ///< of contacts tried
};

/// Climbs from random sets of up to eight weighted directions to ones whose stiffness tensor, after so many iterations
/// of shaping, has a larger and larger largest eigenvalue. The weights before the first iteration stand for many
/// contacts in one direction. The same result on every call; about half a second.
///
/// No set exceeds (1 + sqrt 3)/2, in the plane (1 + sqrt 2)/2, whatever the number of iterations; the proof is in
/// results/reference/BEYOND.md. The search shows that the bound is sharp, and would show an error in the proof.
StiffestContacts stiffest_contacts(int iterations);

}  // namespace hapbench
