#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <vector>

/// Aligned memory for SIMD loops over packs of eight doubles. The pack type itself is defined in simd.hpp, which
/// must be included from source files only.
namespace hapbench {
namespace simd {

/// Number of doubles in a pack (SIMD lanes).
inline constexpr std::size_t lanes = 8;

/// Returns n rounded up to the next multiple of `lanes`.
constexpr std::size_t padded(std::size_t n) {
  return (n + lanes - 1) / lanes * lanes;
}

/// Sets the eight doubles that start at p to zero; p need not be aligned. This is faster than a loop that clears only
/// the unused lanes of the last pack, because it has no branches.
inline void zero_pack(double* p) {
  std::memset(p, 0, lanes * sizeof(double));
}

}  // namespace simd

/// Standard allocator that aligns memory to 64 bytes, so that a pack of eight doubles never crosses a cache line.
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
