#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace hapbench {

/// 64-bit FNV-1a hash (Fowler, Noll, Vo; draft-eastlake-fnv). Identifies contents; it is not a cryptographic hash.
/// The value does not depend on the byte order of the machine.
class Hash64 {
 public:
  /// Adds a text byte by byte (plain FNV-1a).
  constexpr void bytes(std::string_view text) noexcept {
    for (const char c : text) mix(static_cast<unsigned char>(c));
  }
  /// Adds a 64-bit word in one round, eight times cheaper than byte by byte. The multiplication carries only towards
  /// higher bits, so the upper half of the state is folded into the lower half afterwards. Without folding, the flips
  /// of two sign bits would cancel, so a run and its mirror image could have equal hashes.
  constexpr void word(std::uint64_t value) noexcept {
    mix(value);
    state_ ^= state_ >> 32;
  }
  /// Adds the bit pattern of a number. 0 and -0 differ, and equal hashes mean bit-identical numbers.
  constexpr void real(double value) noexcept { word(std::bit_cast<std::uint64_t>(value)); }

  constexpr std::uint64_t value() const noexcept { return state_; }

 private:
  constexpr void mix(std::uint64_t value) noexcept { state_ = (state_ ^ value) * 0x100000001b3u; }

  std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// Returns the FNV-1a hash of a text.
constexpr std::uint64_t hash_of(std::string_view text) noexcept {
  Hash64 hash;
  hash.bytes(text);
  return hash.value();
}

/// Returns the hash as sixteen lower-case hexadecimal digits.
inline std::string hash_text(std::uint64_t hash) {
  std::string text(16, '0');
  for (std::size_t i = text.size(); i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 0xf];
  return text;
}

}  // namespace hapbench
