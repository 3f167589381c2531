#pragma once

#include <cstdint>

namespace hapbench {

/// Heap allocations of this thread so far: malloc, calloc, realloc and the aligned ones, hence operator new and Eigen's
/// allocator too, which call them. So summary.json can state how many a step loop made (none) instead of claiming it,
/// and tests can count. Programs that link hapbench::counting_malloc have malloc replaced by one that counts: hapbench
/// and its tests. 0 in any other, whose allocations nobody counts.
std::uint64_t heap_allocations() noexcept;

/// The calling thread's count, for that malloc: a run stays on one thread while others may run.
extern constinit thread_local std::uint64_t allocations_of_thread;

/// Counts from its construction on.
class AllocationCount {
 public:
  std::uint64_t value() const noexcept { return heap_allocations() - start_; }

 private:
  std::uint64_t start_ = heap_allocations();
};

}  // namespace hapbench
