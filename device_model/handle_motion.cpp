#include "device_model/handle_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "device_model/impedance_device.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Largest argument of the power series [rad] and number of its terms. For arguments up to 1/4, the n-th term
/// decreases as 4^-n / n! for S, P and V and as 1 / n! for the integrals, so twenty terms reach rounding accuracy.
constexpr double kMaxStep = 0.25;
constexpr int kTerms = 20;

/// Returns the solution, computed by power series in time. S and V have the derivatives V and -damping V - stiffness S.
/// The integrals of p = S^2 and r = V^2 are Z and W; the derivatives of p and r contain q = S V.
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

/// Returns the solution of `law` after twice the time `m.time`, computed from the solution `m`.
FreeMotion doubled(const MotionLaw& law, const FreeMotion& m) noexcept {
  const double k = law.stiffness, S2 = m.S * m.S;
  // The handle starts at rest under an acceleration g and reaches x = P g. At this position, the spring reduces the
  // acceleration by k P g.
  const double left = 1.0 - k * m.P;  // remaining fraction of g
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
  for (double size = (law.damping + std::sqrt(law.stiffness)) * time; size > kMaxStep; size *= 0.5) ++doublings;
  FreeMotion motion = by_series(law, std::ldexp(time, -doublings));
  for (; doublings > 0; --doublings) motion = doubled(law, motion);
  motion.time = time;
  return motion;
}

// With a = damping / 2, n = g - a v and d^2 = a^2 - stiffness, the velocity is e^(-a t) (v cosh(d t) + n sinh(d t)
// / d). If d^2 < 0, cosine and sine with w = sqrt(-d^2) replace cosh and sinh.
double time_to_stop(const MotionLaw& law, double v, double g) noexcept {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const double a = 0.5 * law.damping, n = g - a * v, square = a * a - law.stiffness;
  if (square < 0.0) {
    const double w = std::sqrt(-square);
    if (v == 0.0) return g == 0.0 ? kNever : std::numbers::pi / w;
    return v > 0.0 ? math::atan2(v * w, -n) / w : math::atan2(-v * w, n) / w;
  }
  const double t = -v / n, d = std::sqrt(square);
  if (!(t > 0.0) || d * t >= 1.0) return kNever;
  // For small d t the quotient equals t to rounding accuracy. This also avoids the division by d = 0.
  return d * t < 1e-8 ? t : math::atanh(d * t) / d;
}

HandleMotionBase::HandleMotionBase(const ImpedanceDeviceConfig& device, const AttachedHand& hand)
    : viscous_(device.viscous), coulomb_(device.coulomb), hand_(hand) {}

HandleMotion::HandleMotion(const ImpedanceDeviceConfig& device, const AttachedHand& hand)
    : HandleMotionBase(device, hand),
      handle_mass_(device.handle_mass),
      mass_(device.handle_mass + hand.mass),
      law_{(device.viscous + hand.damping) / mass_, hand.stiffness / mass_} {}

void HandleMotion::reset(const HandleState& handle) noexcept {
  handle_ = handle;
  work_ = {.stored = -stored()};
  set_hand_force(Vec3::Zero());
}

void HandleMotion::advance(const Vec3& motors, const FreeMotion& interval) noexcept {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (coulomb_ == 0.0) {
      move(axis, motors[axis], 0.0, interval);
    } else {
      advance_with_friction(axis, motors[axis], interval);
    }
  }
}

/// Returns the hand's force on the handle at its current position, as if the handle were at rest [N].
double HandleMotion::hand_force_if_at_rest(Eigen::Index axis) const noexcept {
  return hand_force_at_rest_[axis] - hand_.stiffness * (handle_.position[axis] - origin_[axis]);
}

void HandleMotion::advance_with_friction(Eigen::Index axis, double motors, const FreeMotion& interval) noexcept {
  double& v = handle_.velocity[axis];
  for (double remaining = interval.time; remaining > 0.0;) {
    const double force = motors + hand_force_if_at_rest(axis);
    if (v == 0.0 && std::abs(force) <= coulomb_) return;  // the handle sticks until a force changes
    const double friction = std::copysign(coulomb_, v == 0.0 ? -force : -v);
    const double stop_time = time_to_stop(law_, v, (force + friction) / mass_);
    if (!(stop_time < remaining))
      return move(axis, motors, friction, remaining == interval.time ? interval : free_motion(law_, remaining));
    move(axis, motors, friction, free_motion(law_, stop_time));
    v = 0.0;
    remaining -= stop_time;
  }
}

/// Moves one axis and adds the work of each force to work_. Precondition: if there is friction, the velocity keeps its
/// sign.
void HandleMotion::move(Eigen::Index axis, double motors, double friction, const FreeMotion& motion) noexcept {
  const double hand = hand_force_if_at_rest(axis), v = handle_.velocity[axis];
  const double g = (motors + hand + friction) / mass_;
  const double displacement = v * motion.S + g * motion.P, after = v * motion.V + g * motion.S;
  // Integral of the squared velocity.
  const double squares = v * v * motion.W + v * g * motion.S * motion.S + g * g * motion.Z;
  handle_.position[axis] += displacement;
  handle_.velocity[axis] = after;
  work_.actuator += motors * displacement;
  work_.hand += hand * displacement - 0.5 * hand_.stiffness * displacement * displacement - hand_.damping * squares -
                0.5 * hand_.mass * (after * after - v * v);
  work_.dissipated += friction * displacement - viscous_ * squares;
}

using TransitionMatrix = ElasticMotion::Matrix;

// The search for the times at which motors stop or start begins with its longest step and halves it. In the longest
// step, the phase of the fastest mode advances by at most kMaxStep radians.
/// Number of halvings of the longest step that locate the time of a change.
constexpr std::size_t kChangeHalvings = 40;
/// The motors stop or start at a change (advance_to_change). The first step after a change is not searched for a
/// further change. Its length is the longest step, halved kSkipHalvings times.
constexpr std::size_t kSkipHalvings = 12;
/// Largest number of halvings of an interval: the number of bits in a double's mantissa.
constexpr std::size_t kMaxHalvings = 52;

/// Returns the matrix M for which z^T M z is the integral of u^T form u over `time`, where u(0) = z and u' = rates u.
/// Uses a power series in time.
static TransitionMatrix integral(const TransitionMatrix& rates, const TransitionMatrix& form, double time) {
  TransitionMatrix term = form * time, sum = term;
  for (int n = 2; n <= kTerms; ++n) {
    term = ((rates.transpose() * term + term * rates) * (time / n)).eval();
    sum += term;
  }
  return sum;
}

/// Returns the matrix exponential of rates * time, by the power series.
static TransitionMatrix exponential(const TransitionMatrix& rates, double time) {
  TransitionMatrix term = TransitionMatrix::Identity(), sum = term;
  for (int n = 1; n <= kTerms; ++n) {
    term = (term * rates * (time / n)).eval();
    sum += term;
  }
  return sum;
}

/// Returns the solution after twice the time of the solution `p`.
static ElasticMotion::Transition doubled(const ElasticMotion::Transition& p) {
  return {p.map * p.map, p.dissipated + p.map.transpose() * p.dissipated * p.map,
          p.hand + p.map.transpose() * p.hand * p.map};
}

ElasticMotion::ElasticMotion(const ImpedanceDeviceConfig& device, const Transmission& transmission,
                             const AttachedHand& hand)
    : HandleMotionBase(device, hand),
      transmission_(transmission),
      motor_mass_(transmission.motor_share * device.handle_mass),
      handle_mass_((1.0 - transmission.motor_share) * device.handle_mass) {}

/// Returns the matrix A of the motion z' = A z, with motors at rest if `sticking` is true.
ElasticMotion::Matrix ElasticMotion::rates(bool sticking) const {
  const double k = transmission_.stiffness, d = transmission_.damping, m = motor_mass_,
               mass = handle_mass_ + hand_.mass;
  Matrix law = Matrix::Zero();
  law(kHandle, kHandleSpeed) = 1.0;
  law.row(kHandleSpeed) << k / mass, d / mass, -(k + hand_.stiffness) / mass, -(d + hand_.damping) / mass, 0.0,
      1.0 / mass;
  if (sticking) return law;
  law(kMotor, kMotorSpeed) = 1.0;
  law.row(kMotorSpeed) << -k / m, -(viscous_ + d) / m, k / m, d / m, 1.0 / m, 0.0;
  return law;
}

ElasticMotion::Stretch ElasticMotion::stretch(double time) const {
  // Matrices M of the dissipated powers z^T M z [W]: `dissipated` for the device, `hand` for the hand's damper.
  Matrix dissipated = Matrix::Zero(), hand = Matrix::Zero();
  const double d = transmission_.damping;
  dissipated(kMotorSpeed, kMotorSpeed) = viscous_ + d;
  dissipated(kHandleSpeed, kHandleSpeed) = d;
  dissipated(kMotorSpeed, kHandleSpeed) = dissipated(kHandleSpeed, kMotorSpeed) = -d;
  hand(kHandleSpeed, kHandleSpeed) = hand_.damping;

  // Halve the interval until it is a small fraction of the fastest mode's period.
  Stretch stretch;
  const Matrix moving = rates(false);
  double size = (-moving(kMotorSpeed, kMotorSpeed) - moving(kHandleSpeed, kHandleSpeed) +
                 std::sqrt(-moving(kMotorSpeed, kMotor) - moving(kHandleSpeed, kHandle))) *
                time;
  for (; size > kMaxStep && stretch.first < kMaxHalvings; size *= 0.5) ++stretch.first;
  // Compute the shortest steps by power series and the longer steps by doubling.
  const auto halved = [&](const Matrix& law) {
    const std::size_t halvings = coulomb_ == 0.0 ? 0 : std::min(kChangeHalvings, kMaxHalvings - stretch.first);
    std::vector<Transition> transitions(stretch.first + halvings + 1);
    for (std::size_t i = transitions.size(); i-- > 0;) {
      const double part = std::ldexp(time, -static_cast<int>(i));
      transitions[i] = i < stretch.first ? doubled(transitions[i + 1])
                                         : Transition{exponential(law, part), integral(law, dissipated, part),
                                                      integral(law, hand, part)};
    }
    return transitions;
  };
  stretch.moving = halved(moving);
  if (coulomb_ > 0.0) stretch.sticking = halved(rates(true));
  return stretch;
}

void ElasticMotion::reset(const HandleState& handle) noexcept {
  motor_ = handle_ = handle;
  work_ = {.stored = -stored()};
  set_hand_force(Vec3::Zero());
}

void ElasticMotion::advance(const Vec3& motors, const Stretch& stretch) noexcept {
  for (Eigen::Index i = 0; i < 3; ++i) {
    Axis axis{.z = {}, .motors = motors[i]};
    axis.z << motor_.position[i] - origin_[i], motor_.velocity[i], handle_.position[i] - origin_[i],
        handle_.velocity[i], motors[i], hand_force_at_rest_[i];
    if (axis.z.isZero(0.0)) continue;  // the axis is at rest and without any force
    if (coulomb_ == 0.0) {
      apply(axis, stretch.moving[0]);
    } else {
      set_friction(axis, true);
      double left = advance_to_change(axis, stretch, 1.0, 0);
      while (left > 0.0) left = advance_to_change(axis, stretch, left, kSkipHalvings);
    }
    motor_.position[i] = origin_[i] + axis.z[kMotor];
    motor_.velocity[i] = axis.z[kMotorSpeed];
    handle_.position[i] = origin_[i] + axis.z[kHandle];
    handle_.velocity[i] = axis.z[kHandleSpeed];
  }
}

/// Returns the force on the motors at `z` without their friction, as if the motors were at rest [N].
double ElasticMotion::force_on_resting_motors(const Axis& axis, const State& z) const noexcept {
  return axis.motors - transmission_.stiffness * (z[kMotor] - z[kHandle]) + transmission_.damping * z[kHandleSpeed];
}

/// Decides whether the motors stick, and sets the direction of their friction. They stick only if `may_stick` is
/// true.
void ElasticMotion::set_friction(Axis& axis, bool may_stick) const noexcept {
  const double v = axis.z[kMotorSpeed], force = force_on_resting_motors(axis, axis.z);
  axis.sticks = may_stick && v == 0.0 && std::abs(force) <= coulomb_;
  axis.friction = axis.sticks ? 0.0 : std::copysign(coulomb_, v == 0.0 ? -force : -v);
  axis.z[kMotorForce] = axis.motors + axis.friction;
}

/// Returns true if moving motors have reversed, or sticking motors have started to move, before the state `next`.
bool ElasticMotion::changes(const Axis& axis, const State& next) const noexcept {
  if (axis.sticks) return std::abs(force_on_resting_motors(axis, next)) > coulomb_;
  return next[kMotorSpeed] * axis.friction > 0.0;
}

/// Advances one axis by a transition and adds the work of each force to work_.
void ElasticMotion::apply(Axis& axis, const Transition& transition) noexcept {
  const State z = axis.z, next = transition.map * z;
  const double k = hand_.stiffness, displacement = next[kMotor] - z[kMotor];
  work_.actuator += axis.motors * displacement;
  work_.dissipated += axis.friction * displacement - z.dot(transition.dissipated * z);
  work_.hand += z[kHandForce] * (next[kHandle] - z[kHandle]) -
                0.5 * k * (next[kHandle] * next[kHandle] - z[kHandle] * z[kHandle]) - z.dot(transition.hand * z) -
                0.5 * hand_.mass * (next[kHandleSpeed] * next[kHandleSpeed] - z[kHandleSpeed] * z[kHandleSpeed]);
  axis.z = next;
}

/// Advances until the motors stop or start to move, but by at most the fraction `left` of the interval. Returns the
/// fraction of the interval that then remains. If `skip` > 0, the first step is taken without a check, so that the
/// search does not find the previous change again. The length of this first step is the longest search step, halved
/// `skip` times.
double ElasticMotion::advance_to_change(Axis& axis, const Stretch& stretch, double left, std::size_t skip) noexcept {
  const std::vector<Transition>& transitions = axis.sticks ? stretch.sticking : stretch.moving;
  const auto fraction_of = [](std::size_t level) { return std::ldexp(1.0, -static_cast<int>(level)); };
  const std::size_t last = transitions.size() - 1;
  // Take the first step without a check.
  if (skip > 0) {
    std::size_t level = std::min(stretch.first + skip, last);
    while (level < last && fraction_of(level) > left) ++level;
    apply(axis, transitions[level]);
    left = std::max(0.0, left - fraction_of(level));
  }
  for (std::size_t level = stretch.first; left > 0.0;) {
    while (level < last && fraction_of(level) > left) ++level;
    // Take the longest step that fits and has no change.
    if (!changes(axis, transitions[level].map * axis.z)) {
      apply(axis, transitions[level]);
      left = std::max(0.0, left - fraction_of(level));
      continue;
    }
    // Bisect the time of the change.
    while (++level <= last) {
      if (changes(axis, transitions[level].map * axis.z)) continue;
      apply(axis, transitions[level]);
      left -= fraction_of(level);
    }
    if (!axis.sticks) axis.z[kMotorSpeed] = 0.0;
    // Motors that just started must not stick again: the force on them still equals the Coulomb friction, up to
    // rounding.
    set_friction(axis, !axis.sticks);
    return left;
  }
  return 0.0;
}

double ElasticMotion::stored() const noexcept {
  return 0.5 * motor_mass_ * motor_.velocity.squaredNorm() + 0.5 * handle_mass_ * handle_.velocity.squaredNorm() +
         0.5 * transmission_.stiffness * (motor_.position - handle_.position).squaredNorm();
}

namespace {

/// Coefficients of the motion x'' = a - rate x' after a time: x = v S + a P and x' = v + (a - rate v) S, where v is the
/// initial velocity. S [s], P [s^2].
struct Coast {
  double S, P;
};

Coast coast(double rate, double time) noexcept {
  const double z = rate * time;
  if (z < 0.05) {
    // Power series; the omitted terms are below 1e-14 of the sum.
    const double P =
        0.5 - z * (1.0 / 6 - z * (1.0 / 24 - z * (1.0 / 120 - z * (1.0 / 720 - z * (1.0 / 5040 - z / 40320)))));
    return {time * (1.0 - z * P), time * time * P};
  }
  const double S = -math::expm1(-z) / rate;
  return {S, (time - S) / rate};
}

/// Motion of one axis of a logged handle. The arguments `push` are forces divided by the mass [m/s^2].
struct Axis {
  double rate, coulomb;  ///< b / m [1/s], c / m [m/s^2]
  double x, v;           ///< position [m], velocity [m/s]

  /// Advances a handle at rest by `time` [s]. The handle sticks, or starts to move in the direction of `push`.
  void leave_rest(double push, double time) noexcept {
    v = 0.0;
    if (std::abs(push) <= coulomb || time <= 0.0) return;
    const double net = push - std::copysign(coulomb, push);
    const Coast by = coast(rate, time);
    x += net * by.P;
    v = net * by.S;
  }

  void advance(double push, double time) noexcept {
    if (v == 0.0) return leave_rest(push, time);
    const double net = push - std::copysign(coulomb, v);
    const Coast by = coast(rate, time);
    const double after = v + (net - rate * v) * by.S;
    if (coulomb == 0.0 || after * v >= 0.0) {
      x += v * by.S + net * by.P;
      v = after;
      return;
    }
    const double undamped = v / (rate * v - net);  // time to stop if the deceleration stayed constant
    const double decay = rate * undamped,
                 stops = decay > 1e-9 ? 2.0 * math::atanh(decay / (2.0 - decay)) / rate : undamped;
    const Coast to_stop = coast(rate, stops);
    x += v * to_stop.S + net * to_stop.P;
    leave_rest(push, time - stops);
  }
};

}  // namespace

void simulate_log(const LoggedHandle& handle, std::span<const double> times, std::span<const double> forces,
                  std::span<double> positions) noexcept {
  Axis axis{handle.viscous / handle.mass, handle.coulomb / handle.mass, 0.0, handle.velocity};
  double push = handle.offset / handle.mass;
  std::size_t next = 0;  // index of the next force to take effect
  for (std::size_t k = 0; k < times.size(); ++k) {
    positions[k] = axis.x;
    if (k + 1 == times.size()) break;
    double now = times[k];
    // Advance piecewise between the times at which forces take effect.
    for (; times[next] + handle.delay < times[k + 1]; ++next) {
      const double arrives = times[next] + handle.delay;
      if (arrives > now) axis.advance(push, arrives - now), now = arrives;
      push = (forces[next] + handle.offset) / handle.mass;
    }
    axis.advance(push, times[k + 1] - now);
  }
}

}  // namespace hapbench
