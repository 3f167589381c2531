#pragma once

/// Elementary functions that return the same bits with every compiler, instruction set and C library.
///
/// The standard leaves their last digits to the library, and libraries use them: one that finds a fused multiply-add at
/// run time rounds differently on another processor. These use the five operations and the square root that IEEE 754
/// specifies to the last bit, in an order that -ffp-contract=off keeps. A test compares them with an 80-bit libm and
/// holds the error bounds below, in units in the last place (ulp) of the result. Our sources use these instead of those
/// of <cmath>.
///
/// They take as long as the C library's to twice as long, log10 and pow 30 to 50 ns.
/// Arguments outside a function's domain and NaN give NaN; nothing sets errno.
namespace hapbench::math {

/// Errors: sin and cos 0.85 ulp, tan 2.5 ulp, or 1e-29 if that is more. Of arguments beyond 1e6 they keep an absolute
/// error of 1e-15, beyond 1e15, where neighbouring arguments are 0.1 rad apart, only the range.
double sin(double x) noexcept;
double cos(double x) noexcept;
double tan(double x) noexcept;
/// The same sine and cosine in little more time than one.
struct SineCosine {
  double sine, cosine;
};
SineCosine sine_cosine(double x) noexcept;

/// Errors: atan2 and acos 2 ulp, asin 2.5 ulp. Signs of zeros and infinite arguments count as in the standard.
double atan2(double y, double x) noexcept;
double asin(double x) noexcept;
double acos(double x) noexcept;

/// Errors: 0.7 ulp for exp, 1.2 ulp for expm1 (e^x - 1).
double exp(double x) noexcept;
double expm1(double x) noexcept;

/// Errors: log 1 ulp; log10 0.51 ulp, so that that of a power of ten is exact; atanh 2.5 ulp.
double log(double x) noexcept;
double log10(double x) noexcept;
double atanh(double x) noexcept;

/// x^y for x >= 0. Error: 0.8 ulp, and a result that is a double is exact.
double pow(double x, double y) noexcept;

/// The square root of x^2 + y^2 without overflow on the way. Error: 1.2 ulp.
double hypot(double x, double y) noexcept;

}  // namespace hapbench::math
