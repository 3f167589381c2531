#pragma once

#include <cstddef>

namespace hapbench::test {

/// Calls of operator new in this process so far; the tests of this binary replace it.
std::size_t allocation_count() noexcept;

}  // namespace hapbench::test
