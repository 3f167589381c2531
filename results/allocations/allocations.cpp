#include "results/allocations/allocations.hpp"

namespace hapbench {

constinit thread_local std::uint64_t allocations_of_thread = 0;

}  // namespace hapbench
