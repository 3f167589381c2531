#include "results/observe/butterworth.hpp"

#include <cassert>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {

// Prototype: one section s^2 / (s^2 + s/Q + 1) per conjugate pole pair, 1/Q = 2 cos(pi/8) and 2 cos(3 pi/8). Setting
// s = (1 - z^-1) / (k (1 + z^-1)) with k = tan(pi fc / fs) and multiplying out gives, with n = 1 / (1 + k/Q + k^2):
// a1 = 2 n (k^2 - 1), a2 = n (1 - k/Q + k^2), b0 = n, b1 = -2n, b2 = n.
HighPass::HighPass(double cutoff, double sampling_rate) {
  assert(0.0 < cutoff && cutoff < 0.5 * sampling_rate);
  const double k = math::tan(std::numbers::pi * cutoff / sampling_rate);
  const double pole_angles[] = {std::numbers::pi / 8.0, 3.0 * std::numbers::pi / 8.0};
  for (std::size_t i = 0; i < biquads_.size(); ++i) {
    const double k_over_q = k * 2.0 * math::cos(pole_angles[i]);
    const double n = 1.0 / (1.0 + k_over_q + k * k);
    biquads_[i].b0 = n;
    biquads_[i].a1 = 2.0 * n * (k * k - 1.0);
    biquads_[i].a2 = n * (1.0 - k_over_q + k * k);
  }
}

Vec3 HighPass::filter(const Vec3& sample) noexcept {
  Vec3 x = sample;
  for (Biquad& q : biquads_) {
    const Vec3 bx = q.b0 * x;
    const Vec3 y = bx + q.s1;
    q.s1 = -2.0 * bx - q.a1 * y + q.s2;
    q.s2 = bx - q.a2 * y;
    x = y;
  }
  return x;
}

// At rest the first section turns the constant x into 0, so that b0 x + s1 = 0 and s2 = b2 x; the second one sees
// zeros. Only doublings and sign changes are involved: the zero is exact.
void HighPass::settle_at(const Vec3& value) noexcept {
  biquads_[0].s1 = -(biquads_[0].b0 * value);
  biquads_[0].s2 = biquads_[0].b0 * value;
  biquads_[1].s1 = biquads_[1].s2 = Vec3::Zero();
}

}  // namespace hapbench
