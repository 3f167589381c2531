#pragma once

#include <bit>
#include <limits>
#include <span>
#include <string>

#include "sim/core/math.hpp"
#include "sim/core/random.hpp"
#include "sim/core/simd.hpp"

/// Self-test of the compiler's vector type: compares every operation of simd.hpp with a scalar loop over the lanes.
/// Compilers have been wrong: with clang 14, `where` of libstdc++ 12's <experimental/simd> selects the wrong lanes
/// of AVX-512. The build runs this test (simd_check.cpp) and stops if an operation is wrong.
namespace hapbench::simd {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline const AlignedDoubles kSpecial = {0.0, -0.0, 1.0, -1.0, kInf, -kInf, kNaN, 1e-310};

inline AlignedDoubles values(const Pack& a) {
  AlignedDoubles v(lanes);
  store(a, v.data());
  return v;
}

/// Returns true if x and y have the same bits or are both NaN. The sign and payload of a computed NaN are not
/// defined, so all NaNs count as equal.
inline bool same(double x, double y) {
  return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y) || (x != x && y != y);
}

/// Returns eight numbers of random sizes and signs. On average every second number is a special value (zero,
/// infinity, NaN, subnormal).
inline AlignedDoubles random_numbers(Random& random) {
  AlignedDoubles numbers(lanes);
  for (double& number : numbers) {
    const double size = math::pow(10.0, random.uniform(-5.0, 5.0));
    number = random.below(2) == 0 ? kSpecial[random.below(lanes)] : random.uniform(-size, size);
  }
  return numbers;
}

/// An arithmetic operation on packs and its scalar reference.
struct Operation {
  const char* name;
  Pack (*packs)(Pack a, const Pack& b);
  double (*scalars)(double a, double b);
};
inline const Operation kOperations[] = {
    {"load", [](Pack a, const Pack&) { return a; }, [](double a, double) { return a; }},
    {"broadcast", [](Pack, const Pack&) { return Pack(2.5); }, [](double, double) { return 2.5; }},
    {"+", [](Pack a, const Pack& b) { return a + b; }, [](double a, double b) { return a + b; }},
    {"+=", [](Pack a, const Pack& b) { return a += b, a; }, [](double a, double b) { return a + b; }},
    {"-", [](Pack a, const Pack& b) { return a - b; }, [](double a, double b) { return a - b; }},
    {"*", [](Pack a, const Pack& b) { return a * b; }, [](double a, double b) { return a * b; }},
    {"/", [](Pack a, const Pack& b) { return a / b; }, [](double a, double b) { return a / b; }},
    {"negate", [](Pack a, const Pack&) { return -a; }, [](double a, double) { return -a; }},
    {"abs", [](Pack a, const Pack&) { return abs(a); }, [](double a, double) { return a < 0.0 ? -a : a; }},
    {"sqrt", [](Pack a, const Pack&) { return sqrt(a); }, [](double a, double) { return std::sqrt(a); }},
    {"min", [](Pack a, const Pack& b) { return min(a, b); }, [](double a, double b) { return b < a ? b : a; }},
    {"max", [](Pack a, const Pack& b) { return max(a, b); }, [](double a, double b) { return a < b ? b : a; }},
    {"select", [](Pack a, const Pack& b) { return select(a < b, a, b); },
     [](double a, double b) { return a < b ? a : b; }},
};

/// A comparison or logical operation on packs and its scalar reference.
struct Comparison {
  const char* name;
  Mask (*packs)(const Pack& a, const Pack& b);
  bool (*scalars)(double a, double b);
};
inline const Comparison kComparisons[] = {
    {"<", [](const Pack& a, const Pack& b) { return a < b; }, [](double a, double b) { return a < b; }},
    {"<=", [](const Pack& a, const Pack& b) { return a <= b; }, [](double a, double b) { return a <= b; }},
    {">", [](const Pack& a, const Pack& b) { return a > b; }, [](double a, double b) { return a > b; }},
    {">=", [](const Pack& a, const Pack& b) { return a >= b; }, [](double a, double b) { return a >= b; }},
    {"!", [](const Pack& a, const Pack& b) { return !(a < b); }, [](double a, double b) { return !(a < b); }},
    {"&&", [](const Pack& a, const Pack& b) { return a <= b && a >= b; }, [](double a, double b) { return a == b; }},
    {"||", [](const Pack& a, const Pack& b) { return a < b || a >= Pack(1.0); },
     [](double a, double b) { return a < b || a >= 1.0; }},
};

/// Returns false if bits() or any() of the comparison's mask is wrong for the numbers in a and b.
inline bool masks_are_right(const Comparison& comparison, const AlignedDoubles& a, const AlignedDoubles& b) {
  const Mask mask = comparison.packs(load(a.data()), load(b.data()));
  unsigned expected = 0;
  for (std::size_t k = 0; k < lanes; ++k) expected |= static_cast<unsigned>(comparison.scalars(a[k], b[k])) << k;
  return bits(mask) == expected && any(mask) == (expected != 0);
}

/// Returns false if min_lane, max_lane or sum is wrong. The sum must be added in the order that `sum` documents.
inline bool reductions_are_right(const AlignedDoubles& a) {
  double smallest = a[0], largest = a[0];
  for (const double x : a) {
    smallest = x < smallest ? x : smallest;
    largest = largest < x ? x : largest;
  }
  const Pack pack = load(a.data());
  return same(min_lane(pack), smallest) && same(max_lane(pack), largest) &&
         same(sum(pack), ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7])));
}

/// Returns false if store_selected does not write the elements selected by the mask in order and without gaps.
inline bool selection_is_right(unsigned mask, const AlignedDoubles& from) {
  alignas(64) static constexpr std::uint32_t kNumbers[lanes] = {10, 11, 12, 13, 14, 15, 16, 17};
  double to[lanes];
  std::uint32_t to_numbers[lanes];
  store_selected(static_cast<std::uint8_t>(mask), from.data(), to);
  store_selected(static_cast<std::uint8_t>(mask), kNumbers, to_numbers);
  std::size_t n = 0;
  for (std::size_t i = 0; i < lanes; ++i) {
    if ((mask >> i) % 2 == 0) continue;
    if (!same(to[n], from[i]) || to_numbers[n] != kNumbers[i]) return false;
    ++n;
  }
  return true;
}

/// Evaluates all operations on random and special numbers. Returns the name of the first wrong operation, or an
/// empty string if all are correct.
inline std::string first_wrong_operation(std::span<const Operation> operations) {
  Random random(1);
  for (unsigned i = 0; i < 10'000; ++i) {
    const AlignedDoubles a = random_numbers(random), b = random_numbers(random);
    for (const Operation& operation : operations) {
      const AlignedDoubles result = values(operation.packs(load(a.data()), load(b.data())));
      for (std::size_t k = 0; k < lanes; ++k)
        if (!same(result[k], operation.scalars(a[k], b[k]))) return operation.name;
    }
    for (const Comparison& comparison : kComparisons)
      if (!masks_are_right(comparison, a, b)) return comparison.name;
    if (!reductions_are_right(a)) return "reduction";
    if (!selection_is_right(i % 256, a)) return "store_selected";
  }
  return "";
}

}  // namespace hapbench::simd
