#pragma once

#include <cstddef>
#include <cstring>

/// How many doubles the hot loops take at a time, for headers, which must not include simd.hpp.
namespace hapbench::simd {

inline constexpr std::size_t lanes = 8;

/// n rounded up to whole packs.
constexpr std::size_t padded(std::size_t n) {
  return (n + lanes - 1) / lanes * lanes;
}

/// Zeroes the eight doubles from p on, aligned or not: a store, where a loop to the end of the last pack has branches.
inline void zero_pack(double* p) {
  std::memset(p, 0, lanes * sizeof(double));
}

}  // namespace hapbench::simd
