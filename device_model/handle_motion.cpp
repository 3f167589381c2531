#include "device_model/handle_motion.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "device_model/impedance_device.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Terms decrease as 4^-n / n! for S, P and V and as 1 / n! for the integrals, so twenty suffice for both.
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

/// The solution after twice the time of `m`.
FreeMotion doubled(const MotionLaw& law, const FreeMotion& m) noexcept {
  const double k = law.stiffness, S2 = m.S * m.S;
  const double left = 1.0 - k * m.P;  // share of g left at the place where g alone has led
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
    return v > 0.0 ? math::atan2(v * w, -n) / w : math::atan2(-v * w, n) / w;
  }
  const double t = -v / n, d = std::sqrt(square);
  if (!(t > 0.0) || d * t >= 1.0) return kNever;
  // For small arguments the quotient is t to rounding, and d may be zero.
  return d * t < 1e-8 ? t : math::atanh(d * t) / d;
}

HandleMotion::HandleMotion(const ImpedanceDeviceConfig& device, const AttachedHand& hand)
    : handle_mass_(device.handle_mass),
      viscous_(device.viscous),
      coulomb_(device.coulomb),
      hand_(hand),
      mass_(device.handle_mass + hand.mass),
      law_{(device.viscous + hand.damping) / mass_, hand.stiffness / mass_} {}

void HandleMotion::reset(const HandleState& handle) noexcept {
  handle_ = handle;
  work_ = {};
  stored_at_reset_ = 0.5 * handle_mass_ * handle_.velocity.squaredNorm();
  take_hand(Vec3::Zero());
}

void HandleMotion::take_hand(const Vec3& force) noexcept {
  origin_ = handle_.position;
  push_ = force + hand_.damping * handle_.velocity;
}

void HandleMotion::advance(const Vec3& motors, const FreeMotion& stretch) noexcept {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (coulomb_ == 0.0) {
      move(axis, motors[axis], 0.0, stretch);
    } else {
      advance_with_friction(axis, motors[axis], stretch);
    }
  }
}

/// Force of the hand on the handle at its position, if it were at rest [N].
double HandleMotion::hand_at_rest(Eigen::Index axis) const noexcept {
  return push_[axis] - hand_.stiffness * (handle_.position[axis] - origin_[axis]);
}

void HandleMotion::advance_with_friction(Eigen::Index axis, double motors, const FreeMotion& stretch) noexcept {
  double& v = handle_.velocity[axis];
  for (double left = stretch.time; left > 0.0;) {
    const double force = motors + hand_at_rest(axis);
    if (v == 0.0 && std::abs(force) <= coulomb_) return;  // sticks until a force changes
    const double friction = std::copysign(coulomb_, v == 0.0 ? -force : -v);
    const double stops = time_of_rest(law_, v, (force + friction) / mass_);
    if (!(stops < left)) return move(axis, motors, friction, left == stretch.time ? stretch : free_motion(law_, left));
    move(axis, motors, friction, free_motion(law_, stops));
    v = 0.0;
    left -= stops;
  }
}

/// Precondition: the velocity keeps its sign, if there is friction.
void HandleMotion::move(Eigen::Index axis, double motors, double friction, const FreeMotion& by) noexcept {
  const double hand = hand_at_rest(axis), v = handle_.velocity[axis];
  const double g = (motors + hand + friction) / mass_;
  const double way = v * by.S + g * by.P, after = v * by.V + g * by.S;
  const double squares = v * v * by.W + v * g * by.S * by.S + g * g * by.Z;  // integral of the squared velocity
  handle_.position[axis] += way;
  handle_.velocity[axis] = after;
  work_.actuator += motors * way;
  work_.hand += hand * way - 0.5 * hand_.stiffness * way * way - hand_.damping * squares -
                0.5 * hand_.mass * (after * after - v * v);
  work_.dissipated += friction * way - viscous_ * squares;
}

DeviceEnergy HandleMotion::energy() const noexcept {
  DeviceEnergy energy = work_;
  energy.stored = 0.5 * handle_mass_ * handle_.velocity.squaredNorm() - stored_at_reset_;
  return energy;
}

}  // namespace hapbench
