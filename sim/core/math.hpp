#pragma once

/// Elementary functions that return the same bits with every compiler, instruction set and C library.
///
/// The C++ standard does not specify the last digits of the functions of <cmath>. C libraries therefore differ;
/// some choose a fused multiply-add at run time and round differently on another processor. The functions here use
/// only the five operations (+, -, *, /, sqrt) that IEEE 754 specifies to the last bit, in an order that
/// -ffp-contract=off preserves. A test compares them with an 80-bit libm and checks the error bounds stated below,
/// in units in the last place (ulp) of the result. All sources of hapbench use these functions instead of <cmath>.
///
/// Cost: one to two times the time of the C library's functions; log10 and pow take 30 to 50 ns. Arguments outside a
/// function's domain and NaN return NaN. No function sets errno.
namespace hapbench::math {

/// Sine, cosine and tangent of x [rad]. Errors: 0.85 ulp for sin and cos; 2.5 ulp or 1e-29 (the larger) for tan.
/// For |x| > 1e6 the absolute error is 1e-15. For |x| > 1e15 neighbouring doubles are 0.1 rad apart, so only the
/// range of the results is correct.
double sin(double x) noexcept;
double cos(double x) noexcept;
double tan(double x) noexcept;
/// Sine and cosine of x [rad], with the same bits as sin() and cos(), in little more time than sin() alone.
struct SineCosine {
  double sine, cosine;
};
SineCosine sine_cosine(double x) noexcept;

/// Inverse trigonometric functions [rad]. Errors: 2 ulp for atan2 and acos, 2.5 ulp for asin. atan2 treats signed
/// zeros and infinite arguments as the C++ standard does.
double atan2(double y, double x) noexcept;
double asin(double x) noexcept;
double acos(double x) noexcept;

/// Returns e^x and e^x - 1. Errors: 0.7 ulp for exp, 1.2 ulp for expm1.
double exp(double x) noexcept;
double expm1(double x) noexcept;

/// Natural logarithm, decimal logarithm and inverse hyperbolic tangent. Errors: 1 ulp for log, 2.5 ulp for atanh,
/// 0.51 ulp for log10. The log10 of a power of ten is exact.
double log(double x) noexcept;
double log10(double x) noexcept;
double atanh(double x) noexcept;

/// Returns x^y for x >= 0. Error: 0.8 ulp. If the exact result is a double, the result is exact.
double pow(double x, double y) noexcept;

/// Returns sqrt(x^2 + y^2) without overflow of the squares. Error: 1.2 ulp.
double hypot(double x, double y) noexcept;

}  // namespace hapbench::math
