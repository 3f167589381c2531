#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace hapbench {

/// Numbers >= 0 counted by size, for quantiles in constant memory. The bins are read off the bits of the number's
/// square: its exponent and the first five bits of its mantissa, 32 bins to a factor of two. So adding costs a shift
/// and an increment, histograms of several runs add up, and the answer does not depend on any order. Squares, because
/// norms come as squares.
class MagnitudeHistogram {
 public:
  /// A quantile between kLeast and kMost is off by at most this share: a bin is sqrt(33 / 32) - 1 = 1.55 % wide, and
  /// its middle stands for it.
  static constexpr double kRelativeError = 0.0078;
  static constexpr double kLeast = 0x1p-30;  ///< smaller numbers count as 0
  static constexpr double kMost = 0x1p20;    ///< numbers from here on count as infinite

  /// Counts the number whose square this is. Precondition: square >= 0; at most 2^32 - 1 numbers in all.
  void add_square(double square) noexcept { ++counts_[bin_of(square)]; }
  MagnitudeHistogram& operator+=(const MagnitudeHistogram& other) noexcept;

  /// The nearest-rank quantile: the smallest number that at least the share p of all do not exceed. Precondition:
  /// 0 < p <= 1 and not empty.
  double quantile(double p) const noexcept;

 private:
  static constexpr int kDroppedBits = 52 - 5;
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(kLeast * kLeast) >> kDroppedBits;
  static constexpr std::uint64_t kEnd = std::bit_cast<std::uint64_t>(kMost * kMost) >> kDroppedBits;
  static constexpr std::size_t kBins = kEnd - kFirst + 2;  ///< with one for what is smaller and one for what is larger

  static std::size_t bin_of(double square) noexcept {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(square) >> kDroppedBits;
    return bits < kFirst ? 0 : bits < kEnd ? bits - kFirst + 1 : kBins - 1;
  }

  std::array<std::uint32_t, kBins> counts_{};
};

}  // namespace hapbench
