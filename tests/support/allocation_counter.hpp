#pragma once

#include <cstdint>

namespace hapbench::test {

/// Heap allocations of the whole process so far: malloc, calloc, realloc and the aligned ones, hence operator new and
/// Eigen's allocator too, which call them. Link allocation_counter.cpp into the executable: it replaces malloc, or
/// hooks into the sanitizer's.
std::uint64_t heap_allocations();

/// Counts from its construction on.
class AllocationCount {
 public:
  std::uint64_t value() const { return heap_allocations() - start_; }

 private:
  std::uint64_t start_ = heap_allocations();
};

}  // namespace hapbench::test
