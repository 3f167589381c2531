#pragma once

#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

/// epsilon of the definition: small enough that rho_i = 1 - epsilon c_i is 1 to six digits, large enough that the
/// weights are unique and the six equations are solved to rounding.
inline constexpr double kExactShapingEpsilon = 1e-6;

/// Computes the weights that minimise ½|S - I|²_F + (epsilon/2)|c|², c >= 0, into the buffer and returns the number of
/// Newton steps. At the optimum rho_i = 1 - epsilon c_i where c_i > 0 and rho_i >= 1 where c_i = 0; tr S >= |S|²_F,
/// hence lambda_max(S) <= (1 + sqrt 3)/2 (planar: (1 + sqrt 2)/2). Precondition: padded contacts. O(n) per step, about
/// two Newton steps. The result depends on the order of the contacts by rounding only.
int solve_exact_shaping(ContactBuffer& contacts) noexcept;

}  // namespace hapbench
