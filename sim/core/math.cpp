#include "sim/core/math.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace hapbench::math {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

/// Double-double number: the unevaluated sum of two doubles, with the second below the last digit of the first. It
/// has 106 bits.
struct DoubleDouble {
  double high, low;
};

constexpr DoubleDouble kTwoPi = {0x1.921fb54442d18p+2, 0x1.1a62633145c07p-52};   // 2 pi
constexpr DoubleDouble kPi = {0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};      // pi
constexpr DoubleDouble kHalfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};  // pi/2
// pi/2 and ln 2 as sums of doubles. The first summands have so few bits that their products with the integers used
// below are exact.
constexpr double kHalfPi1 = 0x1.921fb544p+0, kHalfPi2 = 0x1.0b4611a6p-34, kHalfPi3 = 0x1.3198a2e037073p-69;
constexpr double kLn2High = 0x1.62e42fefa4p-1, kLn2Low = -0x1.8432a1b0e2634p-43;
constexpr DoubleDouble kThird = {0x1.5555555555555p-2, 0x1.5555555555555p-56};
constexpr DoubleDouble kInverseLn10 = {0x1.bcb7b1526e50ep-2, 0x1.95355baaafad3p-57};

/// Returns a + b without rounding error (Knuth's TwoSum).
DoubleDouble two_sum(double a, double b) {
  const double sum = a + b, b_in_sum = sum - a;
  return {sum, (a - (sum - b_in_sum)) + (b - b_in_sum)};
}

/// Returns a + b without rounding error for |a| >= |b| (Dekker's FastTwoSum).
DoubleDouble fast_two_sum(double a, double b) {
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

/// Returns the product a b without rounding error, by splitting each factor into two halves of 26 bits (Dekker's and
/// Veltkamp's algorithms). Precondition: |a|, |b| < 2^990.
DoubleDouble two_product(double a, double b) {
  const double split_a = 0x8000001p0 * a, split_b = 0x8000001p0 * b;
  const double a1 = split_a - (split_a - a), a2 = a - a1, b1 = split_b - (split_b - b), b2 = b - b1;
  const double product = a * b;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

/// Returns the product a b to double-double precision.
DoubleDouble product(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = two_product(a.high, b.high);
  return fast_two_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

/// Returns the integer nearest to x. Precondition: |x| < 2^51.
double nearest(double x) {
  return (x + 0x1.8p52) - 0x1.8p52;
}

/// Returns the polynomial c0 + c1 z + c2 z^2 + … by Estrin's scheme, in which more operations are independent of
/// each other than in Horner's scheme.
template <class... C>
double polynomial(double z, double c0, double c1, C... rest) {
  if constexpr (sizeof...(rest) == 0) {
    return c0 + c1 * z;
  } else if constexpr (sizeof...(rest) == 1) {
    return c0 + c1 * z + z * z * (rest + ...);
  } else {
    return (c0 + c1 * z) + z * z * polynomial(z, rest...);
  }
}

/// Returns sin(x.high + x.low) for |x| <= pi/4 by its Taylor series. The truncation error is below 2^-62 of the
/// result.
double sine_of(const DoubleDouble& x) {
  const double z = x.high * x.high;
  const double series = polynomial(z, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0, -1.0 / 39916800.0,
                                   1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0);
  return x.high + (x.high * z * series + x.low * (1.0 - 0.5 * z));
}

/// Returns cos(x.high + x.low) for |x| <= pi/4 by its Taylor series.
double cosine_of(const DoubleDouble& x) {
  const double z = x.high * x.high, half = 0.5 * z, first = 1.0 - half;
  const double series = polynomial(z, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0, 1.0 / 479001600.0,
                                   -1.0 / 87178291200.0, 1.0 / 20922789888000.0, -1.0 / 6402373705728000.0);
  return first + (((1.0 - first) - half) + (z * z * series - x.high * x.low));
}

/// Decomposition of an angle x [rad]: x = quadrant * pi/2 + rest, up to a multiple of 2 pi, with quadrant from 0 to 3
/// and |rest| <= pi/4.
struct Reduced {
  int quadrant;
  DoubleDouble rest;
};

Reduced reduced(double x) {
  if (std::abs(x) <= 0.25 * kPi.high) return {0, {x, 0.0}};
  DoubleDouble angle = {x, 0.0};
  if (std::abs(x) > 0x1p20) {
    // Remove whole turns. std::fmod is exact, but it subtracts multiples of kTwoPi.high, which is smaller than 2 pi
    // by kTwoPi.low. Correct for this difference.
    const double rest = std::fmod(x, kTwoPi.high), turns = nearest((x - rest) / kTwoPi.high);
    angle = two_sum(rest, std::abs(x) < 0x1p50 ? -turns * kTwoPi.low : 0.0);
  }
  // Remove quarter turns, with pi/2 as a sum of three doubles.
  const double n = nearest(angle.high / kHalfPi.high);
  const DoubleDouble leading = two_sum(angle.high - n * kHalfPi1, -n * kHalfPi2);
  return {static_cast<int>(static_cast<std::int64_t>(n) & 3),
          two_sum(leading.high, leading.low + (angle.low - n * kHalfPi3))};
}

/// Returns the sine of quadrant * pi/2 + rest.
double sine_in(int quadrant, const DoubleDouble& rest) {
  const double size = quadrant % 2 == 0 ? sine_of(rest) : cosine_of(rest);
  return quadrant & 2 ? -size : size;
}

/// Parts of e^(x.high + x.low) = 2^k (1 + y + rest), with |y| <= ln 2 / 2. The truncation error of the series is
/// below 2^-57.
struct Exponential {
  int k;
  DoubleDouble power;  ///< y
  double rest;         ///< e^y - 1 - y
};

Exponential exponential_of(const DoubleDouble& x) {
  const double k = nearest(x.high * 0x1.71547652b82fep+0);  // 1 / ln 2
  const DoubleDouble y = two_sum(x.high - k * kLn2High, x.low - k * kLn2Low);
  const double z = y.high;
  const double series =
      polynomial(z, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0, 1.0 / 40320.0,
                 1.0 / 362880.0, 1.0 / 3628800.0, 1.0 / 39916800.0, 1.0 / 479001600.0, 1.0 / 6227020800.0);
  return {static_cast<int>(k), y, z * z * series + y.low * (1.0 + z)};
}

/// Returns x 2^k, rounded once.
double scaled(double x, int k) {
  if (k > -1000 && k < 1000) return x * std::bit_cast<double>(static_cast<std::uint64_t>(k + 1023) << 52);
  return std::ldexp(x, k);
}

/// Returns e^(x.high + x.low).
double exp_of(const DoubleDouble& x) {
  if (x.high > 710.0) return kInfinity;
  if (x.high < -746.0) return 0.0;
  const Exponential e = exponential_of(x);
  const DoubleDouble sum = fast_two_sum(1.0, e.power.high);
  return scaled(sum.high + (sum.low + e.rest), e.k);
}

/// Parts of x = 2^k m with m from sqrt(1/2) to sqrt(2). In this range the logarithms of 2^k and m do not cancel.
/// Precondition: x is finite and > 0.
struct Binary {
  int k;
  double m;
};

Binary binary(double x) {
  int subnormal = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 0x1p54;
    subnormal = -54;
  }
  // The bit patterns of positive doubles increase with their value. The difference from the bits of sqrt(1/2),
  // divided by 2^52, is therefore the exponent k.
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t k = (bits - std::bit_cast<std::int64_t>(0x1.6a09e667f3bcdp-1)) >> 52;
  return {static_cast<int>(k) + subnormal, std::bit_cast<double>(bits - k * (std::int64_t{1} << 52))};
}

/// Returns ln x with a relative error below 2^-64, as k ln 2 + 2 s (1 + s^2/3 + s^4/5 + …) with s = (m - 1) / (m +
/// 1), |s| < 0.172. The first terms are computed in double-double precision. Precondition: x is finite and > 0.
DoubleDouble log_of(double x) {
  const auto [k, m] = binary(x);
  const DoubleDouble sum = two_sum(1.0, m);
  const double s = (m - 1.0) / sum.high;
  // Correct the quotient s by its remainder: `ratio` is s to double-double precision.
  const DoubleDouble back = two_product(s, sum.high);
  const DoubleDouble ratio = {s, ((((m - 1.0) - back.high) - back.low) - s * sum.low) / sum.high};
  const DoubleDouble z = product(ratio, ratio);
  const double series = polynomial(z.high, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0,
                                   1.0 / 17.0, 1.0 / 19.0, 1.0 / 21.0, 1.0 / 23.0, 1.0 / 25.0);
  DoubleDouble tail = product(z, kThird);
  tail = fast_two_sum(tail.high, tail.low + z.high * z.high * series);
  tail = product(ratio, tail);
  const DoubleDouble of_m = fast_two_sum(2.0 * ratio.high, 2.0 * (ratio.low + tail.high));
  // The rounding error of `low` is less than 2^-64 of the logarithm.
  const DoubleDouble whole = two_sum(k * kLn2High, of_m.high);
  const double low = whole.low + (k * kLn2Low + (of_m.low + 2.0 * tail.low));
  return two_sum(whole.high, low);
}

/// Returns atan(x) - x for |x| <= 1/8. The truncation error is below 2^-63 of the result.
double atan_remainder(double x) {
  const double z = x * x;
  return x * z *
         polynomial(z, -1.0 / 3.0, 1.0 / 5.0, -1.0 / 7.0, 1.0 / 9.0, -1.0 / 11.0, 1.0 / 13.0, -1.0 / 15.0, 1.0 / 17.0,
                    -1.0 / 19.0);
}

}  // namespace

double sin(double x) noexcept {
  if (x == 0.0) return x;
  if (!std::isfinite(x)) return kNaN;
  const Reduced r = reduced(x);
  return sine_in(r.quadrant, r.rest);
}

double cos(double x) noexcept {
  if (!std::isfinite(x)) return kNaN;
  const Reduced r = reduced(x);
  return sine_in(r.quadrant + 1, r.rest);
}

SineCosine sine_cosine(double x) noexcept {
  if (x == 0.0) return {x, 1.0};
  if (!std::isfinite(x)) return {kNaN, kNaN};
  const Reduced r = reduced(x);
  const double sine = sine_of(r.rest), cosine = cosine_of(r.rest);
  const SineCosine turned = r.quadrant % 2 == 0 ? SineCosine{sine, cosine} : SineCosine{cosine, -sine};
  return r.quadrant < 2 ? turned : SineCosine{-turned.sine, -turned.cosine};
}

double tan(double x) noexcept {
  const auto [sine, cosine] = sine_cosine(x);
  return sine / cosine;
}

double atan2(double y, double x) noexcept {
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  // Reduce the problem to the angle arctan(small / large) in [0, pi/4]. Scale both numbers against overflow and
  // underflow.
  double small = std::abs(y), large = std::abs(x);
  const bool steep = small > large;
  if (steep) std::swap(small, large);
  if (std::isinf(large)) {
    small = std::isinf(small) ? 1.0 : 0.0;
    large = 1.0;
  } else if (large > 0x1p1000 || large < 0x1p-900) {
    const double scale = large > 1.0 ? 0x1p-100 : 0x1p100;
    small *= scale;
    large *= scale;
  }
  // The angle is arctan(c) + arctan(u), where c is the multiple of 1/4 closest to small / large. The table has
  // arctan(0), arctan(1/4), … arctan(1).
  static constexpr DoubleDouble kArctangents[] = {{0.0, 0.0},
                                                  {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
                                                  {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
                                                  {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
                                                  {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55}};
  const auto quarters = large > 0.0 ? static_cast<int>(4.0 * (small / large) + 0.5) : 0;
  const double c = 0.25 * quarters;
  const double over = quarters == 3 ? (small - large) + 0.25 * large : small - c * large;  // exact
  const double u = large > 0.0 ? over / (large + c * small) : 0.0;
  const DoubleDouble arc = kArctangents[quarters];
  // Find the offset and sign of the angle in its octant.
  double sign = 1.0;
  DoubleDouble base = {0.0, 0.0};
  if (steep) {
    base = kHalfPi;
    sign = std::signbit(x) ? 1.0 : -1.0;
  } else if (std::signbit(x)) {
    base = kPi;
    sign = -1.0;
  }
  // Add the offset and both arctangents without losing their low digits.
  const DoubleDouble first = two_sum(base.high, sign * arc.high);
  const DoubleDouble second = two_sum(first.high, sign * u);
  const double angle = second.high + (second.low + (first.low + (base.low + sign * (arc.low + atan_remainder(u)))));
  return std::copysign(angle, y);
}

double asin(double x) noexcept {
  return atan2(x, std::sqrt((1.0 - x) * (1.0 + x)));
}

double acos(double x) noexcept {
  return atan2(std::sqrt((1.0 - x) * (1.0 + x)), x);
}

double exp(double x) noexcept {
  return std::isnan(x) ? kNaN : exp_of({x, 0.0});
}

double expm1(double x) noexcept {
  if (std::isnan(x) || x == 0.0) return x;
  if (x > 710.0) return kInfinity;
  if (x < -40.0) return -1.0;
  const Exponential e = exponential_of({x, 0.0});
  if (e.k == 0) return e.power.high + e.rest;
  if (e.k > 60) return exp_of({x, 0.0});
  // Compute 2^k (1 + y + rest) - 1. Start with 2^k - 1, because this difference is exact.
  const double power = scaled(1.0, e.k);
  const DoubleDouble leading = two_sum(power - 1.0, power * e.power.high);
  return leading.high + (leading.low + power * e.rest);
}

double log(double x) noexcept {
  if (!(x >= 0.0)) return kNaN;
  if (x == 0.0) return -kInfinity;
  if (std::isinf(x)) return x;
  // Use the series of log_of() with 2 s = f - s f. The term that is rounded last is then small compared with f.
  const auto [k, m] = binary(x);
  const double f = m - 1.0, s = f / (m + 1.0), z = s * s;
  const double series = z * polynomial(z, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0, 2.0 / 9.0, 2.0 / 11.0, 2.0 / 13.0,
                                       2.0 / 15.0, 2.0 / 17.0, 2.0 / 19.0, 2.0 / 21.0);
  const DoubleDouble leading = two_sum(k * kLn2High, f);
  return leading.high + (leading.low + (k * kLn2Low - s * (f - series)));
}

double log10(double x) noexcept {
  if (!(x > 0.0) || std::isinf(x)) return log(x);
  return product(log_of(x), kInverseLn10).high;
}

double atanh(double x) noexcept {
  if (!(std::abs(x) <= 1.0)) return kNaN;
  if (std::abs(x) == 1.0) return std::copysign(kInfinity, x);
  // For small |x| use the series, because the sum 1 + x would round off digits of x.
  const double z = x * x;
  if (std::abs(x) > 0.3) return 0.5 * log((1.0 + x) / (1.0 - x));
  return x + x * z *
                 polynomial(z, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0,
                            1.0 / 17.0, 1.0 / 19.0, 1.0 / 21.0, 1.0 / 23.0, 1.0 / 25.0, 1.0 / 27.0, 1.0 / 29.0);
}

double pow(double x, double y) noexcept {
  if (!(x >= 0.0) || std::isnan(y)) return kNaN;
  if (y == 0.0 || x == 1.0) return 1.0;
  if (x == 0.0 || std::isinf(x)) return (x == 0.0) == (y > 0.0) ? 0.0 : kInfinity;
  const DoubleDouble log_x = log_of(x);
  if (!(std::abs(log_x.high * y) < 800.0)) return (log_x.high > 0.0) == (y > 0.0) ? kInfinity : 0.0;
  return exp_of(product(log_x, {y, 0.0}));
}

double hypot(double x, double y) noexcept {
  x = std::abs(x);
  y = std::abs(y);
  if (std::isinf(x) || std::isinf(y)) return kInfinity;
  // Scale against overflow and underflow of the squares.
  const double large = x < y ? y : x;
  double scale = 1.0;
  if (large > 0x1p500) scale = 0x1p-600;
  if (large < 0x1p-450) scale = 0x1p600;
  x *= scale;
  y *= scale;
  return std::sqrt(x * x + y * y) / scale;
}

}  // namespace hapbench::math
