#pragma once

#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

/// Weight epsilon of the regularisation in solve_exact_shaping(). It is small enough that rho_i = 1 - epsilon c_i is
/// 1 to six digits. It is large enough that the weights are unique and the solver's six equations can be solved to
/// rounding.
inline constexpr double kExactShapingEpsilon = 1e-6;

/// Writes the weights c >= 0 that minimise ½|S - I|²_F + (epsilon/2)|c|² into the buffer, and returns the
/// number of Newton steps. S = sum c_i u_i u_i^T is the stiffness tensor, rho_i = u_i^T S u_i the stiffness
/// ratio of contact i, |.|_F the Frobenius norm.
///
/// At the minimum, rho_i = 1 - epsilon c_i where c_i > 0, and rho_i >= 1 where c_i = 0. Also tr S >= |S|²_F,
/// hence lambda_max(S) <= (1 + sqrt 3)/2, and (1 + sqrt 2)/2 in planar scenes. Precondition: the contacts are
/// padded. O(n) for each Newton step, usually two steps. The order of the contacts changes the result by
/// rounding only.
int solve_exact_shaping(ContactBuffer& contacts) noexcept;

}  // namespace hapbench
