#pragma once

#include <cstddef>

/// How many doubles the hot loops take at a time, for headers, which must not include simd.hpp.
namespace hapbench::simd {

inline constexpr std::size_t lanes = 8;

/// n rounded up to whole packs.
constexpr std::size_t padded(std::size_t n) {
  return (n + lanes - 1) / lanes * lanes;
}

}  // namespace hapbench::simd
