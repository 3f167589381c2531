#pragma once

#include <cstddef>
#include <cstdlib>

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

/// Whether tests take as many cases as they can, as under scripts/test --all.
inline bool soaks() {
  static const bool soak = std::getenv("HAPBENCH_SOAK") != nullptr;
  return soak;
}

/// How often a loop over random cases runs: all of n in a soak, and a tenth otherwise. Sanitized code is about thirty
/// times slower and looks for errors of memory and arithmetic, which a thirtieth shows as well.
inline std::size_t cases(std::size_t n) {
  const std::size_t part = HAPBENCH_TEST_SANITIZED != 0 ? 30 : soaks() ? 1 : 10;
  return (n + part - 1) / part;
}

/// 1; under AddressSanitizer n, for tests that take every nth case or an nth of the steps there.
inline std::size_t sanitized(std::size_t n) {
  return HAPBENCH_TEST_SANITIZED != 0 ? n : 1;
}

}  // namespace hapbench::test
