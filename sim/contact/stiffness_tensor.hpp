#pragma once

#include "sim/contact/contact_buffer.hpp"

/// The stiffness tensor S = sum c_i u_i u_i^T in units of K and the stiffness ratios rho_i = u_i^T S u_i (thesis Eq. 3
/// and 4). S has six independent entries, so ratios cost O(n); the thesis's n x n matrix of squared inner products is
/// never built. Precondition of all functions: the contacts are padded (ContactBuffer::pad).
namespace hapbench {

/// S from the buffer's weights. O(n).
Mat3 stiffness_tensor(const ContactBuffer& contacts);

/// Sum of c_i d_i u_i u_i^T over the contacts with c_i d_i > 0 [m]; times K, the loads along their directions, whose
/// trace is their sum. O(n).
Mat3 load_tensor(const ContactBuffer& contacts);

/// Sum c_i d_i u_i [m]: the rendered penetration depth vector, thesis Eq. 6. O(n).
Vec3 weighted_depth(const ContactBuffer& contacts);

struct RatioRange {
  double min = 0.0;
  double max = 0.0;
};

/// Smallest and largest ratio u_i^T S u_i over the contacts; zeros without contacts. O(n).
RatioRange ratio_range(const ContactBuffer& contacts, const Mat3& S);

/// Largest eigenvalue of a symmetric matrix, to rounding. Iterative, about 0.3 us: the closed form loses half of the
/// digits if the largest eigenvalue is double, as it is for a well-shaped tensor.
double lambda_max(const Mat3& S);

}  // namespace hapbench
