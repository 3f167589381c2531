#pragma once

#include <cstddef>

namespace hapbench::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

/// How often a loop over random cases runs. Sanitized code is about thirty times slower and looks for errors of memory
/// and arithmetic, which a fraction of the cases shows as well; the numbers that count are those of the Release build.
constexpr std::size_t cases(std::size_t n) {
  return kSanitized ? (n + 29) / 30 : n;
}

}  // namespace hapbench::test
