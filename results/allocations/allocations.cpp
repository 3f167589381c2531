#include "results/allocations/allocations.hpp"

namespace hapbench {

constinit thread_local std::uint64_t allocations_of_thread = 0;

std::uint64_t heap_allocations() noexcept {
  return allocations_of_thread;
}

}  // namespace hapbench
