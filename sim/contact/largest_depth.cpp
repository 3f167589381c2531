#include <limits>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {

double ContactBuffer::largest_depth() const noexcept {
  if (empty()) return 0.0;
  const simd::Pack least(-std::numeric_limits<double>::infinity());
  simd::Pack largest = least;
  const std::size_t whole = size_ / simd::lanes * simd::lanes;
  for (std::size_t i = 0; i < whole; i += simd::lanes) largest = simd::max(largest, simd::load(&depth[i]));
  if (whole < size_) {
    const simd::Mask own = simd::lanes_between(0, size_ - whole);
    largest = simd::max(largest, simd::select(own, simd::load(&depth[whole]), least));
  }
  return simd::max_lane(largest);
}

}  // namespace hapbench
