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

/// Allocates on 64-byte boundaries, so that a pack of eight doubles never straddles a cache line. If `Unset`, a
/// vector's `resize` leaves new elements uninitialised: several threads then fill a large column, and each touches the
/// pages it fills first.
template <class T, bool Unset = false>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t alignment{64};
  template <class U>
  struct rebind {
    using other = CacheLineAllocator<U, Unset>;
  };

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U, Unset>&) noexcept {}

  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), alignment)); }
  void deallocate(T* p, std::size_t) noexcept { ::operator delete(p, alignment); }
  template <class U>
  void construct(U* p) requires Unset {
    ::new (static_cast<void*>(p)) U;
  }
  bool operator==(const CacheLineAllocator&) const = default;
};

using AlignedDoubles = std::vector<double, CacheLineAllocator<double>>;
using UnsetDoubles = std::vector<double, CacheLineAllocator<double, true>>;

}  // namespace hapbench
