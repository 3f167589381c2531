#pragma once

#include <cstdint>

namespace hapbench {

/// Calls of operator new in this thread so far, counted by the program's replacement of it (allocations.cpp); 0
/// throughout in a program that does not link that file.
std::uint64_t heap_allocations() noexcept;

}  // namespace hapbench
