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

/// Beta_i over sigma_E of thesis F.2; zeros when sigma_E <= 1e-12.
Eigen::VectorXd tandpasta_weights(const Dense& contacts);

}  // namespace hapbench::test
