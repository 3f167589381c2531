#pragma once

#include <span>

#include "sim/core/types.hpp"

namespace hapbench {

/// The QR decomposition, by Householder reflections, of a matrix with three rows and at most three independent columns.
/// Eigen has one for matrices of any size; it takes longer for these, and seconds to compile.
class SmallQr {
 public:
  /// Precondition: at most three columns.
  explicit SmallQr(std::span<const Vec3> columns) noexcept;

  /// The coefficients of the columns that come nearest to b, in the least-squares sense; 0 beyond the last column.
  Vec3 solve(Vec3 b) const noexcept;
  /// The orthogonal projector onto the span of the columns.
  Mat3 projector() const noexcept;

 private:
  /// Reflects in the plane perpendicular to reflection k, I - tau v v^T with v_k = 1 and zeros before.
  void reflect(Eigen::Index k, Vec3& x) const noexcept;

  Eigen::Index size_;
  Mat3 R_ = Mat3::Zero();  ///< upper triangle of R; below the diagonal, column k holds the end of the k-th v
  Vec3 tau_ = Vec3::Zero();
};

}  // namespace hapbench
