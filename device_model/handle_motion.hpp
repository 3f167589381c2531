#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "sim/loop/device.hpp"

namespace hapbench {

struct ImpedanceDeviceConfig;

/// Impedance of a hand: how its force changes with the handle's motion between two samples,
///
///   f_hand = f_k - stiffness (x - x_k) - damping (x' - x'_k) - mass x''
///
/// where f_k, x_k and x'_k are the force, position and velocity at sample k. This is a mass fixed to the handle,
/// with a spring and a damper to a target that keeps the position and velocity of the sample. All fields are zero
/// for a hand whose force is sampled and held.
struct AttachedHand {
  double mass = 0.0;       ///< [kg]
  double stiffness = 0.0;  ///< [N/m]
  double damping = 0.0;    ///< [N s/m]
};

/// Law of motion of a body on a spring and a damper under a constant force. Damping, stiffness and the constant
/// acceleration g = force / mass are per unit of mass. Position x is relative to the initial position:
///
///   x'' = g - damping x' - stiffness x,   x(0) = 0,   x'(0) = v
struct MotionLaw {
  double damping = 0.0;    ///< [1/s], >= 0
  double stiffness = 0.0;  ///< [1/s^2], >= 0
};

/// Coefficients of the exact solution of a MotionLaw after `time`, for an initial velocity v and a constant
/// acceleration g (force / mass):
///
///   x = v S + g P,   x' = v V + g S,   integral of x'^2 = v^2 W + v g S^2 + g^2 Z
struct FreeMotion {
  double time = 0.0;                 ///< [s]
  double S = 0.0, P = 0.0, V = 1.0;  ///< [s], [s^2], dimensionless
  double W = 0.0, Z = 0.0;           ///< [s], [s^3]
};

/// Returns the solution of `law` after `time` [s]. Computes the solution for a small fraction of the time by a power
/// series, and then doubles the fraction repeatedly. The relative error is a few units in the last place for any
/// damping, stiffness and time, whether the motion oscillates or creeps. Takes about 0.1 us.
FreeMotion free_motion(const MotionLaw& law, double time) noexcept;

/// Returns the first time after the start at which the velocity is zero [s]; infinity if there is no such time. `v`:
/// initial velocity [m/s]; `g`: constant acceleration [m/s^2], force / mass. In closed form.
double time_to_stop(const MotionLaw& law, double v, double g) noexcept;

/// Base of HandleMotion and ElasticMotion: holds the device's friction and the hand's force.
class HandleMotionBase {
 public:
  /// Sets the hand's force at the current sample [N]. It stays valid until the next call; between samples it
  /// changes with the motion according to AttachedHand.
  void set_hand_force(const Vec3& force) noexcept {
    origin_ = handle_.position;
    hand_force_at_rest_ = force + hand_.damping * handle_.velocity;
  }
  const HandleState& handle() const noexcept { return handle_; }

 protected:
  HandleMotionBase(const ImpedanceDeviceConfig& device, const AttachedHand& hand);

  double viscous_, coulomb_;  ///< friction of the device: coefficient [N s/m] and force [N]
  AttachedHand hand_;
  HandleState handle_;
  Vec3 origin_ = Vec3::Zero();              ///< position of the handle at the last sample [m]
  Vec3 hand_force_at_rest_ = Vec3::Zero();  ///< hand's force on a handle at rest at origin_ [N]
  DeviceEnergy work_;  ///< work of each force since the reset; `stored` is minus the energy stored at the reset [J]
};

/// Motion of a handle with friction under forces that are constant between samples, in each axis separately and
/// without discretisation error:
///
///   m x'' = f - b x' - c sign(x') + f_hand
///
/// with m = handle_mass, b = viscous, c = coulomb of the device, and the force f of the motors. Coulomb friction is
/// exact: a closed form gives the instant at which the handle stops. The handle then sticks as long as the sum of the
/// other forces is at most c, and otherwise starts to move in the direction of this sum. A step of T seconds has at
/// most 2 + w T / pi stops, where w is the angular frequency [rad/s] of the handle on the hand's spring.
class HandleMotion : public HandleMotionBase {
 public:
  HandleMotion(const ImpedanceDeviceConfig& device, const AttachedHand& hand);

  /// Returns the law of motion between stops. The caller computes the argument `interval` of `advance` as
  /// free_motion(law(), time).
  const MotionLaw& law() const noexcept { return law_; }

  void reset(const HandleState& handle) noexcept;
  /// Advances by `interval.time` under a constant force of the motors [N]. Precondition: `interval` was computed from
  /// law(). Allocates nothing.
  void advance(const Vec3& motors, const FreeMotion& interval) noexcept;

  /// Returns the energy balance since the reset. `stored` excludes the kinetic energy of an attached hand: the hand's
  /// work includes the inertia force of this mass.
  DeviceEnergy energy() const noexcept { return work_.plus_stored(stored()); }

 private:
  void advance_with_friction(Eigen::Index axis, double motors, const FreeMotion& interval) noexcept;
  double hand_force_if_at_rest(Eigen::Index axis) const noexcept;
  double stored() const noexcept { return 0.5 * handle_mass_ * handle_.velocity.squaredNorm(); }
  void move(Eigen::Index axis, double motors, double friction, const FreeMotion& motion) noexcept;

  double handle_mass_;
  double mass_;  ///< mass of handle and hand [kg]
  MotionLaw law_;
};

/// Elastic transmission of an impedance device: a spring and a damper between motors and handle.
struct Transmission {
  double motor_share = 0.5;   ///< fraction of the device's mass on the motors' side, in (0, 1)
  double stiffness = 10'000;  ///< k between motors and handle [N/m]
  double damping = 1.0;       ///< d between motors and handle [N s/m]
};

/// Motion of motors and handle as two masses on an elastic transmission, under forces that are constant between
/// samples, in each axis separately and without discretisation error:
///
///   m_m x_m'' = f - b x_m' - c sign(x_m') - k (x_m - x_h) - d (x_m' - x_h')
///   m_h x_h'' = f_hand                    + k (x_m - x_h) + d (x_m' - x_h')
///
/// Indices m and h denote motors and handle: m_m = motor_share handle_mass, m_h is the remaining mass. Friction (b, c)
/// and the motors' force f act on the motors' side; the hand's force acts on the handle. The symbols b, c, f and f_hand
/// have the same meaning as in HandleMotion. With Coulomb friction the motors stop, stick as long as the sum of the
/// other forces is at most c, and then start to move. No closed form gives the instants at which the motors stop or
/// start. The motion is tested at points in time between which the phase of the fastest mode advances by at most a
/// quarter radian. Bisection then locates a change between two neighbouring points to rounding accuracy. Two changes
/// between neighbouring points may be missed.
class ElasticMotion : public HandleMotionBase {
 public:
  /// State of one axis: (x_m, v_m, x_h, v_h, force on the motors, force on the handle) [m, m/s, m, m/s, N, N].
  /// Positions are relative to the handle's position at the last sample.
  using State = Eigen::Matrix<double, 6, 1>;
  using Matrix = Eigen::Matrix<double, 6, 6>;

  /// Exact solution after a fixed time, for the initial state z: the final state is `map` z. Viscous friction and
  /// the transmission's damper dissipate z^T `dissipated` z [J]; the hand's damper dissipates z^T `hand` z [J].
  struct Transition {
    Matrix map, dissipated, hand;
  };
  /// Solutions for an interval and for its repeated halvings (entry i: 2^-i of the interval), with moving and with
  /// sticking motors. `sticking` is empty without Coulomb friction. Takes about a millisecond to compute.
  struct Stretch {
    std::vector<Transition> moving, sticking;
    std::size_t first = 0;  ///< index of the longest step in the search for instants at which the motors stop or start
  };

  ElasticMotion(const ImpedanceDeviceConfig& device, const Transmission& transmission, const AttachedHand& hand);

  /// Returns the solutions for an interval of `time` [s], which `advance` needs.
  Stretch stretch(double time) const;

  void reset(const HandleState& handle) noexcept;
  /// Advances by the interval of `stretch` under a constant force of the motors [N]. Allocates nothing.
  void advance(const Vec3& motors, const Stretch& stretch) noexcept;

  /// Returns position and velocity on the motors' side, which the encoder measures.
  const HandleState& motor() const noexcept { return motor_; }
  /// Returns the energy balance since the reset, as HandleMotion::energy does. `stored` includes both masses and the
  /// transmission's spring.
  DeviceEnergy energy() const noexcept { return work_.plus_stored(stored()); }

 private:
  enum : Eigen::Index { kMotor, kMotorSpeed, kHandle, kHandleSpeed, kMotorForce, kHandForce };  ///< indices of State

  /// State of one axis.
  struct Axis {
    State z;
    double motors;          ///< force of the motors, without friction [N]
    double friction = 0.0;  ///< Coulomb friction on the motors [N]; 0 while they stick
    bool sticks = false;    ///< true if friction holds the motors at rest
  };

  Matrix rates(bool sticking) const;
  void set_friction(Axis& axis, bool may_stick) const noexcept;
  bool changes(const Axis& axis, const State& next) const noexcept;
  double force_on_resting_motors(const Axis& axis, const State& z) const noexcept;
  void apply(Axis& axis, const Transition& transition) noexcept;
  double advance_to_change(Axis& axis, const Stretch& stretch, double left, std::size_t skip) noexcept;
  double stored() const noexcept;

  Transmission transmission_;
  double motor_mass_, handle_mass_;  ///< masses of the device, without the hand's mass [kg]
  HandleState motor_;
};

/// Model of one axis of an impedance device in open loop, with the friction of HandleMotion: m x'' = u(t - delay) +
/// offset - b x' - c sign(x'), where u is the commanded force.
struct LoggedHandle {
  double mass = 1.0;      ///< m, total moving mass [kg]
  double viscous = 0.0;   ///< b [N s/m]
  double coulomb = 0.0;   ///< c [N]
  double delay = 0.0;     ///< time from a command to its force [s]
  double offset = 0.0;    ///< constant force in addition to the commands [N]
  double velocity = 0.0;  ///< initial velocity [m/s]
};

/// Simulates a log. Writes the `positions` [m] at `times` [s] of a handle that starts at position 0. Each of `forces`
/// [N] is commanded at the time with the same index. It begins to act `handle.delay` later and acts until the next
/// force begins. Before the first force, only the offset acts. The motion is exact, including stops and rests.
/// Precondition: `times` increase; `times`, `forces` and `positions` have equally many entries. Takes 20 ns for each
/// entry.
void simulate_log(const LoggedHandle& handle, std::span<const double> times, std::span<const double> forces,
                  std::span<double> positions) noexcept;

}  // namespace hapbench
