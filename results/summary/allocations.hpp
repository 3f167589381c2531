#pragma once

#include <cstdint>

namespace hapbench {

/// The calling thread's count, for counting_malloc: a run stays on one thread while others may run.
inline constinit thread_local std::uint64_t allocations_of_thread = 0;

/// Heap allocations of this thread from its construction on: malloc, calloc, realloc and the aligned ones, hence
/// operator new and Eigen's allocator too, which call them. So summary.json states how many a step loop made (none),
/// and tests count. 0 in programs other than hapbench and its tests, which link hapbench::counting_malloc.
class AllocationCount {
 public:
  std::uint64_t value() const noexcept { return allocations_of_thread - start_; }

 private:
  std::uint64_t start_ = allocations_of_thread;
};

}  // namespace hapbench
