#include "algorithms/proxy/small_qr.hpp"

#include <cmath>
#include <limits>

namespace hapbench {

using Eigen::Index;

SmallQr::SmallQr(std::span<const Vec3> columns) noexcept : size_(static_cast<Index>(columns.size())) {
  for (Index k = 0; k < size_; ++k) {
    Vec3 column = columns[static_cast<std::size_t>(k)];
    for (Index j = 0; j < k; ++j) reflect(j, column);
    // The reflection that turns what is left of the column to the axis k.
    double rest2 = 0.0;
    for (Index i = k + 1; i < 3; ++i) rest2 += column[i] * column[i];
    if (rest2 > std::numeric_limits<double>::min()) {
      const double head = column[k], length = std::sqrt(head * head + rest2);
      column[k] = head >= 0.0 ? -length : length;  // of the other sign, so that nothing cancels below
      for (Index i = k + 1; i < 3; ++i) column[i] /= head - column[k];
      tau_[k] = (column[k] - head) / column[k];
    }
    R_.col(k) = column;
  }
}

void SmallQr::reflect(Index k, Vec3& x) const noexcept {
  if (tau_[k] == 0.0) return;
  double dot = 0.0;
  for (Index i = k + 1; i < 3; ++i) dot += R_(i, k) * x[i];
  dot += x[k];
  x[k] -= tau_[k] * dot;
  for (Index i = k + 1; i < 3; ++i) x[i] -= tau_[k] * R_(i, k) * dot;
}

Vec3 SmallQr::solve(Vec3 b) const noexcept {
  for (Index k = 0; k < size_; ++k) reflect(k, b);
  Vec3 x = Vec3::Zero();
  for (Index k = size_; k-- > 0;) {
    x[k] = b[k];
    if (x[k] == 0.0) continue;  // in rounding, dependent columns have a 0 in R
    x[k] /= R_(k, k);
    for (Index i = 0; i < k; ++i) b[i] -= x[k] * R_(i, k);
  }
  return x;
}

Mat3 SmallQr::projector() const noexcept {
  if (size_ == 0) return Mat3::Zero();
  const auto column_of_Q = [this](Index k) {
    Vec3 q = Vec3::Unit(k);
    for (Index j = k + 1; j-- > 0;) reflect(j, q);
    return q;
  };
  Vec3 q = column_of_Q(0);
  Mat3 P = q * q.transpose();
  for (Index k = 1; k < size_; ++k) {
    q = column_of_Q(k);
    P += q * q.transpose();
  }
  return P;
}

}  // namespace hapbench
