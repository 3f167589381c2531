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

/// SIMD arithmetic on packs of eight doubles, with the same results in every build.
///
/// A sum over contacts always keeps eight partial sums: element i is added to partial sum i mod 8. `sum` then adds
/// the partial sums in one fixed order, whatever the register width. Together with -ffp-contract=off this makes the
/// scalar build and every SIMD build agree bit for bit. Include this header from source files only, because the
/// type Pack differs between the builds.
///
/// Intrinsics for single operations are called in their masked form with all lanes set (0xff). The mask does not
/// change the machine code but avoids a false warning of g++ 12 (GCC bug 105593).
namespace hapbench::simd {

/// Forces inlining. In large loops g++ would otherwise call these short functions and pass their packs through
/// memory.
#define HAPBENCH_INLINE [[gnu::always_inline]] inline

#if HAPBENCH_SIMD

using Pack = std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, lanes>>;
using Mask = Pack::mask_type;

/// Reads eight doubles. Precondition: p is aligned to 64 bytes.
HAPBENCH_INLINE Pack load(const double* p) {
  return Pack(p, std::experimental::overaligned<64>);
}
HAPBENCH_INLINE void store(const Pack& a, double* p) {
  a.copy_to(p, std::experimental::overaligned<64>);
}
/// Returns, lane by lane, `yes` where the mask is set and `no` elsewhere.
HAPBENCH_INLINE Pack select(const Mask& m, const Pack& yes, const Pack& no) {
#ifdef __AVX512VL__
  // With clang, `where` of libstdc++ 12 selects the wrong lanes here.
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
/// Returns true if at least one lane of the mask is set.
HAPBENCH_INLINE bool any(const Mask& m) {
  return std::experimental::any_of(m);
}

#else

/// Scalar reference implementation: applies f to each of the eight lanes in a plain loop.
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

/// Returns the mask as bits: bit i of the result is lane i.
HAPBENCH_INLINE std::uint8_t bits(const Mask& m) {
#if HAPBENCH_SIMD
  return static_cast<std::uint8_t>(m.__to_bitset().to_ulong());  // libstdc++'s name for C++26's to_bitset
#else
  unsigned b = 0;
  for (std::size_t i = 0; i < lanes; ++i) b |= static_cast<unsigned>(m.v[i]) << i;
  return static_cast<std::uint8_t>(b);
#endif
}

/// Copies elements to `to`, in order and without gaps: copies element k of the eight elements of `from` if bit k of
/// `selected` is set. Precondition: `from` is aligned to a whole pack, and `to` has room for eight elements, because
/// all eight may be overwritten.
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

/// Copies points to `to`, starting at its index k, and returns the number of copied points. Copies point i + b of
/// `from` if bit b of `selected` is set (b = 0 … 7). The points are stored as one array per coordinate and are copied
/// array by array; copying point by point would take longer than the contact search. Always inline: the search would
/// otherwise save and restore the packs in its registers around the call. Precondition: i is a multiple of eight.
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

/// Returns the mask with lanes first … last - 1 set.
HAPBENCH_INLINE Mask lanes_between(std::size_t first, std::size_t last) {
  alignas(64) static constexpr double kNumber[lanes] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Pack number = load(kNumber);
  return number >= Pack(static_cast<double>(first)) && number < Pack(static_cast<double>(last));
}

HAPBENCH_INLINE Pack abs(const Pack& a) {
  return select(a < Pack(0.0), -a, a);
}

/// Returns b < a ? b : a in each lane. The result is a if both are equal or one of them is NaN, exactly as the
/// processor's min instruction defines it.
HAPBENCH_INLINE Pack min(const Pack& a, const Pack& b) {
#if HAPBENCH_SIMD && defined(__AVX512VL__)
  return Pack(_mm512_maskz_min_pd(0xff, static_cast<__m512d>(b), static_cast<__m512d>(a)));
#else
  return select(b < a, b, a);
#endif
}
/// Returns a < b ? b : a in each lane.
HAPBENCH_INLINE Pack max(const Pack& a, const Pack& b) {
#if HAPBENCH_SIMD && defined(__AVX512VL__)
  return Pack(_mm512_maskz_max_pd(0xff, static_cast<__m512d>(b), static_cast<__m512d>(a)));
#else
  return select(a < b, b, a);
#endif
}

/// Returns the sum of the eight lanes, added pairwise in one fixed order.
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
