#pragma once

#if defined(__x86_64__)
#include <xmmintrin.h>
#else
#include <cfenv>
#endif

namespace hapbench {

/// Sets the floating-point mode in which hapbench computes: round to nearest, subnormal numbers on, no traps. The
/// destructor restores the mode of the caller, with its exception flags. Takes a few nanoseconds on x86-64.
class FloatingPointMode {
 public:
#if defined(__x86_64__)
  FloatingPointMode() noexcept : before_(_mm_getcsr()) {
    _mm_setcsr(0x1f80);
  }
  ~FloatingPointMode() {
    _mm_setcsr(before_);
  }
#else
  FloatingPointMode() noexcept {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~FloatingPointMode() {
    std::fesetenv(&before_);
  }
#endif
  FloatingPointMode(const FloatingPointMode&) = delete;
  FloatingPointMode& operator=(const FloatingPointMode&) = delete;

 private:
#if defined(__x86_64__)
  unsigned before_;
#else
  std::fenv_t before_{};
#endif
};

}  // namespace hapbench
