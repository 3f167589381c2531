#pragma once

#include <cstdint>

namespace hapbench {

/// The calling thread's count, for counting_malloc: a run stays on one thread while others may run.
extern constinit thread_local std::uint64_t allocations_of_thread;

/// Heap allocations of this thread so far: malloc, calloc, realloc and the aligned ones, hence operator new and Eigen's
/// allocator too, which call them. So summary.json states how many a step loop made (none), and tests count. 0 in
/// programs other than hapbench and its tests, which link hapbench::counting_malloc.
inline std::uint64_t heap_allocations() noexcept {
  return allocations_of_thread;
}

/// Counts from its construction on.
class AllocationCount {
 public:
  std::uint64_t value() const noexcept { return heap_allocations() - start_; }

 private:
  std::uint64_t start_ = heap_allocations();
};

}  // namespace hapbench
