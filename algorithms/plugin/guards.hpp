#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>

/// Guards against plugins behind a C interface: they find writes beyond an answer and keep the reason of a failure.
namespace hapbench {

/// Numbers before and after what a plugin writes. No computation gives this signalling NaN.
struct Canaries {
  static constexpr std::size_t kCount = 8;
  double values[kCount];

  Canaries() { std::fill_n(values, kCount, std::bit_cast<double>(std::uint64_t{0x7ff4deadc0ffee00})); }
  void write(double* to) const noexcept { std::memcpy(to, values, sizeof values); }
  bool are_at(const double* from) const noexcept { return std::memcmp(from, values, sizeof values) == 0; }
};
inline const Canaries kCanaries;

/// An answer that a plugin writes, between canaries.
template <class Answer>
struct Guarded {
  Canaries before;
  Answer answer;
  Canaries after;

  bool intact() const noexcept { return kCanaries.are_at(before.values) && kCanaries.are_at(after.values); }
};

/// Why a library failed, in one printable line; allocates nothing.
class FaultText {
 public:
  void set(const char* library, const char* problem) noexcept {
    std::snprintf(text_.data(), text_.size(), "%s fails: %s", library, problem);
    for (char& c : text_) c = c == '\0' || (c >= ' ' && c <= '~') ? c : c == '\n' ? ' ' : '?';
  }
  void clear() noexcept { text_[0] = '\0'; }
  /// Null without a fault.
  const char* text() const noexcept { return text_[0] == '\0' ? nullptr : text_.data(); }

 private:
  std::array<char, 256> text_{};
};

}  // namespace hapbench
