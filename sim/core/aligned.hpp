#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace hapbench {

/// Allocator on 64-byte boundaries, so that a pack of eight doubles never straddles a cache line.
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

/// The same, but what `resize` adds holds no value yet: for large columns that several threads fill at once, each the
/// pages it touches first.
template <class T>
struct UnsetCacheLineAllocator : CacheLineAllocator<T> {
  template <class U>
  struct rebind {
    using other = UnsetCacheLineAllocator<U>;
  };
  template <class U, class... Args>
  void construct(U* p, Args&&... args) {
    if constexpr (sizeof...(Args) == 0)
      ::new (static_cast<void*>(p)) U;
    else
      ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
  }
};

using UnsetDoubles = std::vector<double, UnsetCacheLineAllocator<double>>;

}  // namespace hapbench
