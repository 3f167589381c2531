#pragma once

#include <cstddef>

// 1 under AddressSanitizer, as g++ and clang++ tell it.
#if defined(__SANITIZE_ADDRESS__)
#define HAPBENCH_TEST_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAPBENCH_TEST_SANITIZED 1
#endif
#endif
#ifndef HAPBENCH_TEST_SANITIZED
#define HAPBENCH_TEST_SANITIZED 0
#endif

namespace hapbench::test {

/// How often a loop over random cases runs. Sanitized code is about thirty times slower and looks for errors of memory
/// and arithmetic, which a fraction of the cases shows as well; the numbers that count are those of the Release build.
constexpr std::size_t cases(std::size_t n) {
  return HAPBENCH_TEST_SANITIZED != 0 ? (n + 29) / 30 : n;
}

}  // namespace hapbench::test
