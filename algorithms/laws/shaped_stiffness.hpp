#pragma once

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// Applies `iterations` updates c_i <- c_i / rho_i to weights of 1 (thesis C.4.2), leaves them in the buffer and
/// returns their stiffness tensor. Precondition: padded contacts. O(n) per iteration; a zero gradient gets weight zero.
/// From the first update on lambda_max(S) <= (1 + sqrt 3)/2, planar (1 + sqrt 2)/2 (proof:
/// results/reference/BEYOND.md).
Mat3 shape_weights(ContactBuffer& contacts, int iterations) noexcept;

/// One update c_i <- c_i / (u_i^T S u_i); S must be the tensor of the weights in the buffer. Returns the new tensor.
Mat3 update_shaped_weights(ContactBuffer& contacts, const Mat3& S) noexcept;

}  // namespace hapbench
