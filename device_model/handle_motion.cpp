#include "device_model/handle_motion.hpp"

#include <algorithm>
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

HeldHandle::HeldHandle(const ImpedanceDeviceConfig& device, const AttachedHand& hand)
    : viscous_(device.viscous), coulomb_(device.coulomb), hand_(hand) {}

HandleMotion::HandleMotion(const ImpedanceDeviceConfig& device, const AttachedHand& hand)
    : HeldHandle(device, hand),
      handle_mass_(device.handle_mass),
      mass_(device.handle_mass + hand.mass),
      law_{(device.viscous + hand.damping) / mass_, hand.stiffness / mass_} {}

void HandleMotion::reset(const HandleState& handle) noexcept {
  handle_ = handle;
  work_ = {.stored = -stored()};
  take_hand(Vec3::Zero());
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

using PieceMatrix = ElasticMotion::Matrix;

// The longest piece is kLargest radians of the fastest motion.
constexpr std::size_t kFinest = 40;  ///< halvings of such a piece, which locate a change
constexpr std::size_t kGrain = 12;   ///< halvings of the least that passes after a change before the next
constexpr std::size_t kMostHalvings = 52;

/// Integral of u^T form u over the time, u the state that moves with `rates`, by the power series in time.
static PieceMatrix integral(const PieceMatrix& rates, const PieceMatrix& form, double time) {
  PieceMatrix term = form * time, sum = term;
  for (int n = 2; n <= kTerms; ++n) {
    term = ((rates.transpose() * term + term * rates) * (time / n)).eval();
    sum += term;
  }
  return sum;
}

static PieceMatrix exponential(const PieceMatrix& rates, double time) {
  PieceMatrix term = PieceMatrix::Identity(), sum = term;
  for (int n = 1; n <= kTerms; ++n) {
    term = (term * rates * (time / n)).eval();
    sum += term;
  }
  return sum;
}

static ElasticMotion::Piece doubled(const ElasticMotion::Piece& p) {
  return {p.map * p.map, p.dissipated + p.map.transpose() * p.dissipated * p.map,
          p.hand + p.map.transpose() * p.hand * p.map};
}

ElasticMotion::ElasticMotion(const ImpedanceDeviceConfig& device, const Transmission& transmission,
                             const AttachedHand& hand)
    : HeldHandle(device, hand),
      transmission_(transmission),
      motor_mass_(transmission.motor_share * device.handle_mass),
      handle_mass_((1.0 - transmission.motor_share) * device.handle_mass) {}

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
  Matrix dissipated = Matrix::Zero(), hand = Matrix::Zero();
  const double d = transmission_.damping;
  dissipated(kMotorSpeed, kMotorSpeed) = viscous_ + d;
  dissipated(kHandleSpeed, kHandleSpeed) = d;
  dissipated(kMotorSpeed, kHandleSpeed) = dissipated(kHandleSpeed, kMotorSpeed) = -d;
  hand(kHandleSpeed, kHandleSpeed) = hand_.damping;

  Stretch stretch;
  const Matrix moving = rates(false);
  double size = (-moving(kMotorSpeed, kMotorSpeed) - moving(kHandleSpeed, kHandleSpeed) +
                 std::sqrt(-moving(kMotorSpeed, kMotor) - moving(kHandleSpeed, kHandle))) *
                time;
  for (; size > kLargest && stretch.first < kMostHalvings; size *= 0.5) ++stretch.first;
  const auto halved = [&](const Matrix& law) {
    const std::size_t halvings = coulomb_ == 0.0 ? 0 : std::min(kFinest, kMostHalvings - stretch.first);
    std::vector<Piece> pieces(stretch.first + halvings + 1);
    for (std::size_t i = pieces.size(); i-- > 0;) {
      const double part = std::ldexp(time, -static_cast<int>(i));
      pieces[i] = i < stretch.first
                      ? doubled(pieces[i + 1])
                      : Piece{exponential(law, part), integral(law, dissipated, part), integral(law, hand, part)};
    }
    return pieces;
  };
  stretch.moving = halved(moving);
  if (coulomb_ > 0.0) stretch.sticking = halved(rates(true));
  return stretch;
}

void ElasticMotion::reset(const HandleState& handle) noexcept {
  motor_ = handle_ = handle;
  work_ = {.stored = -stored()};
  take_hand(Vec3::Zero());
}

void ElasticMotion::advance(const Vec3& motors, const Stretch& stretch) noexcept {
  for (Eigen::Index i = 0; i < 3; ++i) {
    Axis axis{.z = {}, .motors = motors[i]};
    axis.z << motor_.position[i] - origin_[i], motor_.velocity[i], handle_.position[i] - origin_[i],
        handle_.velocity[i], motors[i], push_[i];
    if (axis.z.isZero(0.0)) continue;  // rests, and nothing pushes
    if (coulomb_ == 0.0) {
      take(axis, stretch.moving[0]);
    } else {
      start(axis, true);
      double left = advance_to_change(axis, stretch, 1.0, 0);
      while (left > 0.0) left = advance_to_change(axis, stretch, left, kGrain);
    }
    motor_.position[i] = origin_[i] + axis.z[kMotor];
    motor_.velocity[i] = axis.z[kMotorSpeed];
    handle_.position[i] = origin_[i] + axis.z[kHandle];
    handle_.velocity[i] = axis.z[kHandleSpeed];
  }
}

/// Force on the motors at `z`, if they were at rest, without their friction [N].
double ElasticMotion::on_resting_motors(const Axis& axis, const State& z) const noexcept {
  return axis.motors - transmission_.stiffness * (z[kMotor] - z[kHandle]) + transmission_.damping * z[kHandleSpeed];
}

/// Chooses whether the motors stick, if they may, and which way their friction points.
void ElasticMotion::start(Axis& axis, bool may_stick) const noexcept {
  const double v = axis.z[kMotorSpeed], force = on_resting_motors(axis, axis.z);
  axis.sticks = may_stick && v == 0.0 && std::abs(force) <= coulomb_;
  axis.friction = axis.sticks ? 0.0 : std::copysign(coulomb_, v == 0.0 ? -force : -v);
  axis.z[kForce] = axis.motors + axis.friction;
}

/// True where the motors have turned round or broken loose by `next`.
bool ElasticMotion::changes(const Axis& axis, const State& next) const noexcept {
  if (axis.sticks) return std::abs(on_resting_motors(axis, next)) > coulomb_;
  return next[kMotorSpeed] * axis.friction > 0.0;
}

void ElasticMotion::take(Axis& axis, const Piece& piece) noexcept {
  const State z = axis.z, next = piece.map * z;
  const double k = hand_.stiffness, way = next[kMotor] - z[kMotor];
  work_.actuator += axis.motors * way;
  work_.dissipated += axis.friction * way - z.dot(piece.dissipated * z);
  work_.hand += z[kPush] * (next[kHandle] - z[kHandle]) -
                0.5 * k * (next[kHandle] * next[kHandle] - z[kHandle] * z[kHandle]) - z.dot(piece.hand * z) -
                0.5 * hand_.mass * (next[kHandleSpeed] * next[kHandleSpeed] - z[kHandleSpeed] * z[kHandleSpeed]);
  axis.z = next;
}

/// Advances by at most a share `left` of the stretch, until the motors stop or break loose, and returns the share that
/// is left then. `skip`: halvings of the first piece, within which they are not looked at, that is taken first.
double ElasticMotion::advance_to_change(Axis& axis, const Stretch& stretch, double left, std::size_t skip) noexcept {
  const std::vector<Piece>& pieces = axis.sticks ? stretch.sticking : stretch.moving;
  const auto share = [](std::size_t level) { return std::ldexp(1.0, -static_cast<int>(level)); };
  const std::size_t last = pieces.size() - 1;
  if (skip > 0) {
    std::size_t level = std::min(stretch.first + skip, last);
    while (level < last && share(level) > left) ++level;
    take(axis, pieces[level]);
    left = std::max(0.0, left - share(level));
  }
  for (std::size_t level = stretch.first; left > 0.0;) {
    while (level < last && share(level) > left) ++level;
    if (!changes(axis, pieces[level].map * axis.z)) {
      take(axis, pieces[level]);
      left = std::max(0.0, left - share(level));
      continue;
    }
    while (++level <= last) {
      if (changes(axis, pieces[level].map * axis.z)) continue;
      take(axis, pieces[level]);
      left -= share(level);
    }
    if (!axis.sticks) axis.z[kMotorSpeed] = 0.0;
    start(axis, !axis.sticks);  // where motors break loose, the force is c, to rounding
    return left;
  }
  return 0.0;
}

double ElasticMotion::stored() const noexcept {
  return 0.5 * motor_mass_ * motor_.velocity.squaredNorm() + 0.5 * handle_mass_ * handle_.velocity.squaredNorm() +
         0.5 * transmission_.stiffness * (motor_.position - handle_.position).squaredNorm();
}

namespace {

/// x = v S + a P and x' = v + (a - rate v) S after a time, for x'' = a - rate x'.
struct Coast {
  double S, P;
};

Coast coast(double rate, double time) noexcept {
  const double z = rate * time;
  if (z < 0.05) {
    // The next terms are below 1e-14 of the sums.
    const double P =
        0.5 - z * (1.0 / 6 - z * (1.0 / 24 - z * (1.0 / 120 - z * (1.0 / 720 - z * (1.0 / 5040 - z / 40320)))));
    return {time * (1.0 - z * P), time * time * P};
  }
  const double S = -math::expm1(-z) / rate;
  return {S, (time - S) / rate};
}

/// State of the axis, accelerations in place of forces.
struct Axis {
  double rate, grip;
  double x, v;

  void leave_rest(double push, double time) noexcept {
    v = 0.0;
    if (std::abs(push) <= grip || time <= 0.0) return;
    const double net = push - std::copysign(grip, push);
    const Coast by = coast(rate, time);
    x += net * by.P;
    v = net * by.S;
  }

  void advance(double push, double time) noexcept {
    if (v == 0.0) return leave_rest(push, time);
    const double net = push - std::copysign(grip, v);
    const Coast by = coast(rate, time);
    const double after = v + (net - rate * v) * by.S;
    if (grip == 0.0 || after * v >= 0.0) {
      x += v * by.S + net * by.P;
      v = after;
      return;
    }
    const double without = v / (rate * v - net);  // when it stops, were there no viscous friction to change on the way
    const double share = rate * without,
                 stops = share > 1e-9 ? 2.0 * math::atanh(share / (2.0 - share)) / rate : without;
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
  std::size_t next = 0;  // the force that arrives next
  for (std::size_t k = 0; k < times.size(); ++k) {
    positions[k] = axis.x;
    if (k + 1 == times.size()) break;
    double now = times[k];
    for (; times[next] + handle.delay < times[k + 1]; ++next) {
      const double arrives = times[next] + handle.delay;
      if (arrives > now) axis.advance(push, arrives - now), now = arrives;
      push = (forces[next] + handle.offset) / handle.mass;
    }
    axis.advance(push, times[k + 1] - now);
  }
}

}  // namespace hapbench
