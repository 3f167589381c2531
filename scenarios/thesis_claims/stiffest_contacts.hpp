#pragma once

#include <cstddef>

namespace hapbench {

/// As many iterations as it takes: the exact limit.
inline constexpr int kExactLimit = -1;

/// How far above the true supremum rounding may lift a result of the search.
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
/// One update with any weights w gives S = sum w_i U_i / <U_i, S_0> with U_i = u_i u_i^T and S_0 = sum w_j U_j, so m
/// iterations are one from the weights of m - 1, and the supremum over weighted sets is the same for every m >= 1. What
/// is known of it: at the limit tr S >= |S|²_F gives (1 + sqrt 3)/2; the same holds after one update along
/// the leading eigenvector of S_0. The search finds nothing beyond.
StiffestContacts stiffest_contacts(int iterations);

}  // namespace hapbench
