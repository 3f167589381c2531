#pragma once

#include <cstddef>
#include <cstdlib>

// Define HAPBENCH_TEST_SANITIZED as 1 with AddressSanitizer, otherwise as 0. g++ and clang++ report it in different
// ways.
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

/// Returns true if tests run all of their random cases, as under scripts/test --all.
inline bool runs_all_cases() {
  static const bool soak = std::getenv("HAPBENCH_SOAK") != nullptr;
  return soak;
}

/// Returns the number of repetitions of a loop over random cases: n if runs_all_cases(), otherwise a tenth of n. With
/// AddressSanitizer, which is about thirty times slower, returns a thirtieth of n. Fewer cases suffice to find errors
/// of memory and arithmetic.
inline std::size_t cases(std::size_t n) {
  const std::size_t part = HAPBENCH_TEST_SANITIZED != 0 ? 30 : runs_all_cases() ? 1 : 10;
  return (n + part - 1) / part;
}

/// Returns n with AddressSanitizer, otherwise 1. Used by tests that run only every n-th case, or an n-th of the steps,
/// with AddressSanitizer.
inline std::size_t sanitized(std::size_t n) {
  return HAPBENCH_TEST_SANITIZED != 0 ? n : 1;
}

}  // namespace hapbench::test
