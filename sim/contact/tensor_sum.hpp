#pragma once

#include "sim/core/simd.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// S = sum c_i u_i u_i^T, eight contacts at a time, for loops that go over the contacts anyway. For source files only
/// (see simd.hpp).
class TensorSum {
 public:
  void add(const simd::Pack& c, const simd::Pack& x, const simd::Pack& y, const simd::Pack& z) noexcept {
    const simd::Pack cx = c * x, cy = c * y;
    xx_ += cx * x;
    xy_ += cx * y;
    xz_ += cx * z;
    yy_ += cy * y;
    yz_ += cy * z;
    zz_ += c * z * z;
  }
  Mat3 sum() const noexcept {
    Mat3 S;
    S(0, 0) = simd::sum(xx_);
    S(0, 1) = S(1, 0) = simd::sum(xy_);
    S(0, 2) = S(2, 0) = simd::sum(xz_);
    S(1, 1) = simd::sum(yy_);
    S(1, 2) = S(2, 1) = simd::sum(yz_);
    S(2, 2) = simd::sum(zz_);
    return S;
  }

 private:
  simd::Pack xx_{0.0}, xy_{0.0}, xz_{0.0}, yy_{0.0}, yz_{0.0}, zz_{0.0};
};

}  // namespace hapbench
