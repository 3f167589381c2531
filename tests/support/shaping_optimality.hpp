#pragma once

#include "sim/contact/contact_buffer.hpp"

namespace hapbench::test {

/// How well the weights in a buffer solve the problem that defines exact_shaping,
///   min ½|S - I|²_F + (eps/2)|c|², c >= 0,
/// judged in long double from gradients and weights alone.
struct ShapingOptimality {
  /// Largest violation of the optimality condition, in units of the ratio: |u_i|^2 - rho_i = eps c_i where c_i > 0 and
  /// |u_i|^2 - rho_i <= 0 where c_i = 0. (|u_i|^2 is 1 to rounding.)
  double violation = 0.0;
  /// The smallest rho_i + eps max(c) - |u_i|^2: by the condition it is never negative.
  double ratio_margin = 0.0;
  /// |tr S - |S|^2 - eps |c|^2|, zero at the optimum.
  double trace_identity = 0.0;
  double smallest_weight = 0.0;
  double largest_weight = 0.0;
};

ShapingOptimality shaping_optimality(const ContactBuffer& contacts, double eps);

/// Largest violation that double rounding allows for n <= 1000 contacts: 1e-14 of residual is left by design, the eight
/// partial sums of n/8 terms that make up S round by at most (n/8 + 8) eps tr S = 6e-14, and c_i = a_i . w, w up to
/// sqrt 3 / eps, by 1e-15 in eps c_i.
inline constexpr double kShapingRounding = 1e-13;

/// What a violation r of the optimality condition can change: for a strongly convex problem of modulus eps,
/// |c - c'| <= |r| / eps and |S - S'| <= |r| / (2 sqrt eps), where |r|^2 sums over contacts.
double tensor_tolerance(std::size_t contacts, double violation, double eps);
double weight_tolerance(std::size_t contacts, double violation, double eps);

}  // namespace hapbench::test
