#include "sim/contact/stiffness_tensor.hpp"

#include <Eigen/Eigenvalues>
#include <limits>

#include "sim/contact/tensor_sum.hpp"

namespace hapbench {

using simd::load;
using simd::Pack;

Mat3 stiffness_tensor(const ContactBuffer& contacts) {
  TensorSum S;
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes)
    S.add(load(&contacts.weight[i]), load(&contacts.ux[i]), load(&contacts.uy[i]), load(&contacts.uz[i]));
  return S.sum();
}

Vec3 weighted_depth(const ContactBuffer& contacts) {
  Pack gx(0.0), gy(0.0), gz(0.0);
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    const Pack cd = load(&contacts.weight[i]) * load(&contacts.depth[i]);
    gx += cd * load(&contacts.ux[i]);
    gy += cd * load(&contacts.uy[i]);
    gz += cd * load(&contacts.uz[i]);
  }
  return {simd::sum(gx), simd::sum(gy), simd::sum(gz)};
}

RatioRange ratio_range(const ContactBuffer& contacts, const Mat3& S) {
  if (contacts.empty()) return {};
  constexpr double never = std::numeric_limits<double>::infinity();
  Pack smallest(never), largest(-never);
  for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    // Row by row in the order of Eigen's inner products, a + (b + c).
    const auto along = [&](int row) { return Pack(S(row, 0)) * x + (Pack(S(row, 1)) * y + Pack(S(row, 2)) * z); };
    const Pack rho = x * along(0) + (y * along(1) + z * along(2));
    const simd::Mask counts = simd::lanes_between(0, contacts.size() - i);  // not the padding
    smallest = simd::min(smallest, simd::select(counts, rho, Pack(never)));
    largest = simd::max(largest, simd::select(counts, rho, Pack(-never)));
  }
  return {simd::min_lane(smallest), simd::max_lane(largest)};
}

double lambda_max(const Mat3& S) {
  return Eigen::SelfAdjointEigenSolver<Mat3>(S, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

}  // namespace hapbench
