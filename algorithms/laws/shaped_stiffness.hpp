#pragma once

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Writes the weights of stiffness shaping into the buffer and returns their stiffness tensor S (thesis C.4.2).
/// Starts from weights of 1 and applies `iterations` updates c_i <- c_i / rho_i, with the stiffness ratio rho_i
/// = u_i^T S u_i. A zero gradient gets weight zero. After at least one update, lambda_max(S) <= (1 + sqrt 3)/2,
/// and (1 + sqrt 2)/2 in planar scenes (proof: algorithms/SHAPING.md). Precondition: the contacts are
/// padded. O(n) for each iteration.
Mat3 shape_weights(ContactBuffer& contacts, int iterations) noexcept;

/// Applies one update c_i <- c_i / (u_i^T S u_i) and returns the new tensor. Precondition: S is the stiffness
/// tensor of the weights in the buffer.
Mat3 update_shaped_weights(ContactBuffer& contacts, const Mat3& S) noexcept;

}  // namespace hapbench
