#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace hapbench {

/// Axes with direction numbers.
inline constexpr std::size_t kSobolAxes = 53;

/// One coordinate of the Sobol sequence: a (t, s)-sequence in base two, of whose first 2^k points every elementary
/// interval of the axis of length 2^-k holds one.
///
/// Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
/// SIAM J. Sci. Comput. 30 (2008) 2635-2654, the set new-joe-kuo-6.21201, here for polynomials up to degree 8. Points
/// come in the Gray-code order of Antonov and Saleev (1979), the first one is 0.
class SobolAxis {
 public:
  /// Precondition: axis < kSobolAxes.
  explicit SobolAxis(std::size_t axis);

  /// The coordinate of a point, in units of 2^-32.
  std::uint32_t at(std::uint32_t point) const;

 private:
  std::array<std::uint32_t, 32> directions_;  ///< in units of 2^-32
};

}  // namespace hapbench
