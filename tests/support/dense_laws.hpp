#pragma once

#include <Eigen/Dense>

#include "sim/contact/contact_buffer.hpp"

/// The force laws as their formulas are written, with dense matrices over all pairs of contacts: slow,
/// and independent of how the library computes them.
namespace hapbench::test {

/// Contacts as matrices.
struct Dense {
  Eigen::Matrix3Xd U;  ///< a gradient in each column
  Eigen::VectorXd d;   ///< depths

  explicit Dense(const ContactBuffer& contacts);

  Eigen::Index n() const { return d.size(); }
  /// A_ij = <u_i, u_j>^2, the n x n matrix of thesis Eq. 3 and 4.
  Eigen::MatrixXd A() const { return (U.transpose() * U).array().square(); }
  /// Sum c_i u_i u_i^T.
  Mat3 S(const Eigen::VectorXd& c) const { return U * c.asDiagonal() * U.transpose(); }
  /// -K sum c_i d_i u_i.
  Vec3 spring(double K, const Eigen::VectorXd& c) const { return -K * (U * (c.cwiseProduct(d))); }
  /// Sum c_i |d_i|: what rounding errors of the spring force are measured by, in units of K.
  double magnitude(const Eigen::VectorXd& c) const { return c.cwiseAbs().dot(d.cwiseAbs()); }
};

/// The weights the library left in the buffer.
Eigen::VectorXd weights(const ContactBuffer& contacts);

/// Weights after m iterations of thesis Eq. 4 on the n x n matrix: rho = A c, c_i <- c_i / rho_i.
Eigen::VectorXd shaped_weights(const Eigen::MatrixXd& A, int m);

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

}  // namespace hapbench::test
