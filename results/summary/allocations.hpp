#pragma once

#include <cstdint>

namespace hapbench {

/// Number of heap allocations of the calling thread, which counting_malloc increments. It is thread-local because a
/// run stays on one thread while other runs use other threads.
inline constinit thread_local std::uint64_t allocations_of_thread = 0;

/// Counts the heap allocations of the calling thread since the construction of this object: malloc, calloc, realloc and
/// the aligned allocations. These include operator new and Eigen's allocator. summary.json reports the count of the
/// step loop (which is zero). The count is always 0 in programs that do not link hapbench::counting_malloc. The program
/// hapbench and its tests link hapbench::counting_malloc.
class AllocationCount {
 public:
  std::uint64_t value() const noexcept { return allocations_of_thread - start_; }

 private:
  std::uint64_t start_ = allocations_of_thread;
};

}  // namespace hapbench
