#pragma once

#include "algorithms/laws/laws.hpp"

namespace hapbench {

/// Weights after `iterations` updates c_i <- c_i / rho_i from c = 1 (thesis C.4.2), left in the buffer; returns their
/// stiffness tensor. Precondition: padded contacts. O(n) per iteration; a zero gradient gets weight zero. From the
/// first update on lambda_max(S) <= (1 + sqrt 3)/2, planar (1 + sqrt 2)/2 (proof: results/reference/BEYOND.md).
Mat3 shape_weights(ContactBuffer& contacts, int iterations) noexcept;

/// One update c_i <- c_i / (u_i^T S u_i); S must be the tensor of the weights in the buffer. Returns the new tensor.
Mat3 update_shaped_weights(ContactBuffer& contacts, const Mat3& S) noexcept;

/// What the weights of a face of a wedge of half angle w [rad] add up to, from the first update on:
/// 1 / (1 + <u1, u2>^2).
double shaped_wedge_weight(double w) noexcept;

}  // namespace hapbench
