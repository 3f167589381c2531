#pragma once

#include <Eigen/Dense>

#include "sim/contact/contact_buffer.hpp"

/// The force laws computed directly from their formulas, with dense matrices over all pairs of contacts. Slow,
/// and independent of the library's implementation.
namespace hapbench::test {

/// Contacts as matrices and vectors. u_i and d_i are the gradient and depth of contact i.
struct Dense {
  Eigen::Matrix3Xd U;  ///< gradients u_i, one in each column
  Eigen::VectorXd d;   ///< depths d_i [m]

  explicit Dense(const ContactBuffer& contacts);

  Eigen::Index n() const { return d.size(); }
  /// A_ij = <u_i, u_j>^2, the n x n matrix of thesis Eq. 3 and 4.
  Eigen::MatrixXd A() const { return (U.transpose() * U).array().square(); }
  /// Returns the sum of c_i u_i u_i^T for the weights c.
  Mat3 S(const Eigen::VectorXd& c) const { return U * c.asDiagonal() * U.transpose(); }
  /// Returns the spring force -K sum c_i d_i u_i.
  Vec3 spring(double K, const Eigen::VectorXd& c) const { return -K * (U * (c.cwiseProduct(d))); }
  /// Returns the sum of |c_i| |d_i|: the scale of rounding errors of the spring force, in units of K.
  double magnitude(const Eigen::VectorXd& c) const { return c.cwiseAbs().dot(d.cwiseAbs()); }
};

/// Returns the weights that the library wrote into the buffer.
Eigen::VectorXd weights(const ContactBuffer& contacts);

/// Returns the weights c after m iterations of thesis Eq. 4 with the n x n matrix A: rho = A c, c_i <- c_i /
/// rho_i.
Eigen::VectorXd shaped_weights(const Eigen::MatrixXd& A, int m);

/// Measures how well the weights c in a buffer solve the problem that defines exact_shaping,
///   min ½|S - I|²_F + (eps/2)|c|², c >= 0.
/// Computed in long double from the gradients u_i and the weights alone. S is the stiffness tensor in units of
/// K, and rho_i = u_i^T S u_i is the stiffness ratio along contact i.
struct ShapingOptimality {
  /// Largest violation of the optimality condition, in units of the ratio: |u_i|^2 - rho_i = eps c_i if c_i >
  /// 0, and |u_i|^2 - rho_i <= 0 if c_i = 0. (|u_i|^2 is 1 up to rounding.)
  double violation = 0.0;
  /// Smallest rho_i + eps max(c) - |u_i|^2. The optimality condition implies that it is not negative.
  double ratio_margin = 0.0;
  /// |tr S - |S|^2 - eps |c|^2|, which is zero at the optimum.
  double trace_identity = 0.0;
  double smallest_weight = 0.0;
  double largest_weight = 0.0;
};

ShapingOptimality shaping_optimality(const ContactBuffer& contacts, double eps);

/// Largest violation that rounding in double precision allows for n <= 1000 contacts. The solver stops at a
/// residual of 1e-14. S is the sum of eight partial sums of n/8 terms, which round by at most (n/8 + 8) eps tr
/// S = 6e-14 (here eps is the machine epsilon). The solver computes c_i = a_i . w, where a_i is u_i u_i^T as a unit
/// vector of 6 components and |w| is at most sqrt 3 / eps (here eps is that of exact_shaping). This adds an error of
/// 1e-15 in eps c_i.
inline constexpr double kShapingRounding = 1e-13;

}  // namespace hapbench::test
