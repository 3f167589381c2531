#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <vector>

/// Memory for loops that take eight doubles at a time. The packs themselves are in simd.hpp, which headers must not
/// include.
namespace hapbench {
namespace simd {

/// Number of doubles in a pack.
inline constexpr std::size_t lanes = 8;

/// n rounded up to whole packs.
constexpr std::size_t padded(std::size_t n) {
  return (n + lanes - 1) / lanes * lanes;
}

/// Zeroes the eight doubles from p on, aligned or not, without the branches of a loop to the end of the last pack.
inline void zero_pack(double* p) {
  std::memset(p, 0, lanes * sizeof(double));
}

}  // namespace simd

/// Allocates on 64-byte boundaries, so that a pack of eight doubles never straddles a cache line.
template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) noexcept {}

  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
  void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, alignment); }
  bool operator==(const CacheLineAllocator&) const = default;
};

using AlignedDoubles = std::vector<double, CacheLineAllocator<double>>;

}  // namespace hapbench
