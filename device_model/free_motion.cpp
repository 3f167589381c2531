#include "device_model/free_motion.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace hapbench {
namespace {

/// Terms fall as 4^-n / n! for S, P and V and as n! for the integrals: after the twentieth nothing is left of either.
constexpr double kLargest = 0.25;
constexpr int kTerms = 20;

/// The power series in time of S and V, whose derivatives are V and -damping V - stiffness S, and of p = S^2, q = S V
/// and r = V^2, whose integrals are Z, S^2 / 2 and W.
FreeMotion by_series(const MotionLaw& law, double time) noexcept {
  FreeMotion m{.time = time, .V = 0.0};
  double S = 0.0, V = 1.0, p = 0.0, q = 0.0, r = 1.0;
  for (int n = 1; n <= kTerms; ++n) {
    const double h = time / n;
    m.S += S;
    m.V += V;
    m.P += S * h;
    m.Z += p * h;
    m.W += r * h;
    const double S_next = V * h;
    V = -(law.damping * V + law.stiffness * S) * h;
    S = S_next;
    const double p_next = 2.0 * q * h, q_next = (r - law.damping * q - law.stiffness * p) * h;
    r = -2.0 * (law.damping * r + law.stiffness * q) * h;
    p = p_next;
    q = q_next;
  }
  return m;
}

/// The same motion once more, from where the first half ends.
FreeMotion doubled(const MotionLaw& law, const FreeMotion& m) noexcept {
  const double k = law.stiffness, S2 = m.S * m.S;
  const double left = 1.0 - k * m.P;  // of g, where g alone has led
  return {.time = 2.0 * m.time,
          .S = m.S * (m.V + left),
          .P = m.P * (1.0 + left) + S2,
          .V = m.V * m.V - k * S2,
          .W = m.W + m.V * m.V * m.W - k * m.V * m.S * S2 + k * k * S2 * m.Z,
          .Z = m.Z + S2 * m.W + left * m.S * S2 + left * left * m.Z};
}

}  // namespace

FreeMotion free_motion(const MotionLaw& law, double time) noexcept {
  int doublings = 0;
  for (double size = (law.damping + std::sqrt(law.stiffness)) * time; size > kLargest; size *= 0.5) ++doublings;
  FreeMotion motion = by_series(law, std::ldexp(time, -doublings));
  for (; doublings > 0; --doublings) motion = doubled(law, motion);
  motion.time = time;
  return motion;
}

// With a = damping / 2 and n = g - a v the velocity is e^(-a t) (v cosh(d t) + n sinh(d t) / d), d^2 = a^2 - stiffness,
// or the same with cosine and sine.
double time_of_rest(const MotionLaw& law, double v, double g) noexcept {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double a = 0.5 * law.damping, n = g - a * v, square = a * a - law.stiffness;
  if (square < 0.0) {
    const double w = std::sqrt(-square);
    if (v == 0.0) return g == 0.0 ? kNever : std::numbers::pi / w;
    return v > 0.0 ? std::atan2(v * w, -n) / w : std::atan2(-v * w, n) / w;
  }
  const double t = -v / n, d = std::sqrt(square);
  if (!(t > 0.0) || d * t >= 1.0) return kNever;
  // For small arguments the quotient is t to rounding, and d may be zero.
  return d * t < 1e-8 ? t : std::atanh(d * t) / d;
}

}  // namespace hapbench
