#pragma once

#include <cstdint>

namespace hapbench {

/// Heap allocations of this thread so far: malloc, calloc, realloc and the aligned ones, hence operator new and Eigen's
/// allocator too, which call them. So summary.json can state how many a step loop made (none) instead of claiming it,
/// and tests can count. A program that links this library has malloc replaced by one that counts.
std::uint64_t heap_allocations() noexcept;

/// Counts from its construction on.
class AllocationCount {
 public:
  std::uint64_t value() const noexcept { return heap_allocations() - start_; }

 private:
  std::uint64_t start_ = heap_allocations();
};

}  // namespace hapbench
