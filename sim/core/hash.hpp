#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hapbench {

/// FNV-1a, 64 bits (Fowler, Noll, Vo; draft-eastlake-fnv). Identifies contents; not a cryptographic hash. The value
/// does not depend on the machine's byte order.
class Hash64 {
 public:
  /// Plain FNV-1a, byte by byte.
  constexpr void bytes(std::string_view text) noexcept {
    for (const char c : text) mix(static_cast<unsigned char>(c));
  }
  /// Mixes in a whole word in one round, eight times cheaper than byte by byte. Multiplication carries upwards only;
  /// without folding the upper half into the lower one, two flipped sign bits, as in a mirrored run, would cancel.
  constexpr void word(std::uint64_t value) noexcept {
    mix(value);
    state_ ^= state_ >> 32;
  }
  /// Mixes in the bit pattern, so 0 and -0 differ, and equal hashes mean bit-identical numbers.
  constexpr void real(double value) noexcept { word(std::bit_cast<std::uint64_t>(value)); }

  constexpr std::uint64_t value() const noexcept { return state_; }

 private:
  constexpr void mix(std::uint64_t value) noexcept { state_ = (state_ ^ value) * 0x100000001b3u; }

  std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// FNV-1a of a text.
constexpr std::uint64_t hash_of(std::string_view text) noexcept {
  Hash64 hash;
  hash.bytes(text);
  return hash.value();
}

/// Sixteen lower-case hexadecimal digits.
inline std::string hash_text(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = text.size(); i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 0xf];
  return text;
}

}  // namespace hapbench
