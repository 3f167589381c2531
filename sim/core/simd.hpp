#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "sim/core/aligned.hpp"

#ifndef HAPBENCH_SIMD
#error "sim/core/simd.hpp, and what includes it, is for hapbench's own sources; see sim/core/aligned.hpp for yours"
#endif

#if HAPBENCH_SIMD
#include <experimental/simd>
#ifdef __AVX512VL__
#include <immintrin.h>
#endif
#endif

/// Eight doubles at a time, the same arithmetic in every build.
///
/// Sums over contacts always keep eight partial sums (element i goes to partial sum i mod 8) and `sum` adds those in
/// one fixed order, whatever the register width. Together with -ffp-contract=off this makes the scalar build and every
/// SIMD build agree bit for bit. Include from source files only: the type of Pack differs between the two builds.
///
/// Intrinsics of single operations come with the mask of all lanes, 0xff, which makes no difference to the code but
/// avoids a false warning of g++ 12 (GCC bug 105593).
namespace hapbench::simd {

/// In large loops g++ calls these few instructions as functions, with their packs in memory.
#define HAPBENCH_INLINE [[gnu::always_inline]] inline

#if HAPBENCH_SIMD

using Pack = std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, lanes>>;
using Mask = Pack::mask_type;

HAPBENCH_INLINE Pack load(const double* p) {
  return Pack(p, std::experimental::overaligned<64>);
}
HAPBENCH_INLINE void store(const Pack& a, double* p) {
  a.copy_to(p, std::experimental::overaligned<64>);
}
HAPBENCH_INLINE Pack select(const Mask& m, const Pack& yes, const Pack& no) {
#ifdef __AVX512VL__
  // Compiled by clang, `where` of libstdc++ 12 selects the wrong lanes here.
  const auto mask = static_cast<__mmask8>(m.__to_bitset().to_ulong());
  return Pack(_mm512_mask_blend_pd(mask, static_cast<__m512d>(no), static_cast<__m512d>(yes)));
#else
  Pack r = no;
  std::experimental::where(m, r) = yes;
  return r;
#endif
}
HAPBENCH_INLINE Pack sqrt(const Pack& a) {
#ifdef __AVX512VL__
  return Pack(_mm512_maskz_sqrt_pd(0xff, static_cast<__m512d>(a)));
#else
  return std::experimental::sqrt(a);
#endif
}
HAPBENCH_INLINE bool any(const Mask& m) {
  return std::experimental::any_of(m);
}

#else

/// The reference: plain loops over eight lanes.
template <class Result, class Arg, class F>
Result lane_by_lane(const Arg& a, const Arg& b, F f) {
  Result r;
  for (std::size_t i = 0; i < lanes; ++i) r.v[i] = f(a.v[i], b.v[i]);
  return r;
}

struct Mask {
  std::array<bool, lanes> v;

  friend Mask operator&&(const Mask& a, const Mask& b) { return lane_by_lane<Mask>(a, b, std::logical_and()); }
  friend Mask operator||(const Mask& a, const Mask& b) { return lane_by_lane<Mask>(a, b, std::logical_or()); }
  friend Mask operator!(const Mask& a) {
    return lane_by_lane<Mask>(a, a, [](bool x, bool) { return !x; });
  }
};

struct Pack {
  std::array<double, lanes> v;

  Pack() = default;
  Pack(double a) { v.fill(a); }  // NOLINT: implicit, as for the library type

  friend Pack operator+(const Pack& a, const Pack& b) { return lane_by_lane<Pack>(a, b, std::plus()); }
  friend Pack operator-(const Pack& a, const Pack& b) { return lane_by_lane<Pack>(a, b, std::minus()); }
  friend Pack operator*(const Pack& a, const Pack& b) { return lane_by_lane<Pack>(a, b, std::multiplies()); }
  friend Pack operator/(const Pack& a, const Pack& b) { return lane_by_lane<Pack>(a, b, std::divides()); }
  friend Pack operator-(const Pack& a) {
    return lane_by_lane<Pack>(a, a, [](double x, double) { return -x; });
  }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  friend Mask operator<(const Pack& a, const Pack& b) { return lane_by_lane<Mask>(a, b, std::less()); }
  friend Mask operator<=(const Pack& a, const Pack& b) { return lane_by_lane<Mask>(a, b, std::less_equal()); }
  friend Mask operator>(const Pack& a, const Pack& b) { return b < a; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return b <= a; }
};

inline Pack load(const double* p) {
  Pack r;
  for (std::size_t i = 0; i < lanes; ++i) r.v[i] = p[i];
  return r;
}
inline void store(const Pack& a, double* p) {
  for (std::size_t i = 0; i < lanes; ++i) p[i] = a.v[i];
}
inline Pack select(const Mask& m, const Pack& yes, const Pack& no) {
  Pack r;
  for (std::size_t i = 0; i < lanes; ++i) r.v[i] = m.v[i] ? yes.v[i] : no.v[i];
  return r;
}
inline Pack sqrt(const Pack& a) {
  return lane_by_lane<Pack>(a, a, [](double x, double) { return std::sqrt(x); });
}
inline bool any(const Mask& m) {
  bool r = false;
  for (bool b : m.v) r |= b;
  return r;
}

#endif

/// Bit i of the result is lane i of the mask.
HAPBENCH_INLINE std::uint8_t bits(const Mask& m) {
#if HAPBENCH_SIMD
  return static_cast<std::uint8_t>(m.__to_bitset().to_ulong());  // libstdc++'s name for C++26's to_bitset
#else
  unsigned b = 0;
  for (std::size_t i = 0; i < lanes; ++i) b |= static_cast<unsigned>(m.v[i]) << i;
  return static_cast<std::uint8_t>(b);
#endif
}

/// Writes the elements whose bit is set, of eight aligned ones, to `to`, in their order and without gaps. May write
/// eight elements, however few are selected.
#if HAPBENCH_SIMD && defined(__AVX512VL__)
inline void store_selected(std::uint8_t selected, const double* from, double* to) {
  _mm512_storeu_pd(to, _mm512_maskz_compress_pd(selected, _mm512_load_pd(from)));
}
inline void store_selected(std::uint8_t selected, const std::uint32_t* from, std::uint32_t* to) {
  const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), _mm256_maskz_compress_epi32(selected, all));
}
#else
template <class T>
void store_selected(std::uint8_t selected, const T* from, T* to) {
  for (std::size_t i = 0; i < lanes; ++i) {
    *to = from[i];
    to += selected >> i & 1;
  }
}
#endif

/// The same for points in columns: copies those among the eight from i on to the places from k on, and returns their
/// number. Copies column by column, because point by point takes longer than the search. Always inline: searches would
/// otherwise save and restore the packs in their registers around the call. Precondition: i is a multiple of eight.
template <class From, class To>
HAPBENCH_INLINE std::size_t copy_selected(std::uint8_t selected, const From& from, std::size_t i, To& to,
                                          std::size_t k) {
  store_selected(selected, &from.index[i], &to.index[k]);
  store_selected(selected, &from.x[i], &to.x[k]);
  store_selected(selected, &from.y[i], &to.y[k]);
  store_selected(selected, &from.z[i], &to.z[k]);
  store_selected(selected, &from.nx[i], &to.nx[k]);
  store_selected(selected, &from.ny[i], &to.ny[k]);
  store_selected(selected, &from.nz[i], &to.nz[k]);
  return static_cast<std::size_t>(std::popcount(selected));
}

/// The lanes first … last - 1.
HAPBENCH_INLINE Mask lanes_between(std::size_t first, std::size_t last) {
  alignas(64) static constexpr double kNumber[lanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Pack number = load(kNumber);
  return number >= Pack(static_cast<double>(first)) && number < Pack(static_cast<double>(last));
}

HAPBENCH_INLINE Pack abs(const Pack& a) {
  return select(a < Pack(0.0), -a, a);
}

/// b < a ? b : a, hence a if they are equal or one is NaN, exactly as the instruction does.
HAPBENCH_INLINE Pack min(const Pack& a, const Pack& b) {
#if HAPBENCH_SIMD && defined(__AVX512VL__)
  return Pack(_mm512_maskz_min_pd(0xff, static_cast<__m512d>(b), static_cast<__m512d>(a)));
#else
  return select(b < a, b, a);
#endif
}
/// a < b ? b : a
HAPBENCH_INLINE Pack max(const Pack& a, const Pack& b) {
#if HAPBENCH_SIMD && defined(__AVX512VL__)
  return Pack(_mm512_maskz_max_pd(0xff, static_cast<__m512d>(b), static_cast<__m512d>(a)));
#else
  return select(a < b, b, a);
#endif
}

/// The eight partial sums added pairwise in one fixed order.
HAPBENCH_INLINE double sum(const Pack& a) {
#if HAPBENCH_SIMD && defined(__AVX512VL__)
  const auto v = static_cast<__m512d>(a);
  const __m256d half = __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
  return (half[0] + half[2]) + (half[1] + half[3]);
#else
  alignas(64) double v[lanes];
  store(a, v);
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
#endif
}
inline double min_lane(const Pack& a) {
  alignas(64) double v[lanes];
  store(a, v);
  double m = v[0];
  for (double x : v) m = x < m ? x : m;
  return m;
}
inline double max_lane(const Pack& a) {
  alignas(64) double v[lanes];
  store(a, v);
  double m = v[0];
  for (double x : v) m = m < x ? x : m;
  return m;
}

#undef HAPBENCH_INLINE

}  // namespace hapbench::simd
