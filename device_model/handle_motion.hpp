#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "sim/loop/device.hpp"

namespace hapbench {

struct ImpedanceDeviceConfig;

/// How the force of a hand answers the motion of the handle between samples:
///
///   f_hand = f_k - stiffness (x - x_k) - damping (x' - x'_k) - mass x''
///
/// with the force f_k at the sample: a mass, fixed to the handle, on a spring and a damper towards a target with the
/// position and velocity of the sample. All are zero for a hand whose force is sampled and held.
struct AttachedHand {
  double mass = 0.0;       ///< [kg]
  double stiffness = 0.0;  ///< [N/m]
  double damping = 0.0;    ///< [N s/m]
};

/// A body on a spring and a damper under a constant force, per unit of its mass and relative to its initial position:
///
///   x'' = g - damping x' - stiffness x,   x(0) = 0,   x'(0) = v
struct MotionLaw {
  double damping = 0.0;    ///< [1/s], >= 0
  double stiffness = 0.0;  ///< [1/s^2], >= 0
};

/// The exact solution of a MotionLaw after `time`:
///
///   x = v S + g P,   x' = v V + g S,   integral of x'^2 = v^2 W + v g S^2 + g^2 Z
struct FreeMotion {
  double time = 0.0;  ///< [s]
  double S = 0.0, P = 0.0, V = 1.0;
  double W = 0.0, Z = 0.0;
};

/// Solves the law for a time [s] by the power series of a fraction of it, which is then doubled. The relative error is
/// a few roundings for any damping, stiffness and time, in oscillation as well as in creep. Takes about 0.1 us.
FreeMotion free_motion(const MotionLaw& law, double time) noexcept;

/// The first time after the start at which the velocity is zero [s], by the closed form; infinity if there is none.
double time_of_rest(const MotionLaw& law, double v, double g) noexcept;

/// Common base of the two motions of a handle: the friction of the device and the force of the hand.
class HeldHandle {
 public:
  /// Takes the force of the hand at a sample [N], which holds until the next call.
  void take_hand(const Vec3& force) noexcept {
    origin_ = handle_.position;
    push_ = force + hand_.damping * handle_.velocity;
  }
  const HandleState& handle() const noexcept { return handle_; }

 protected:
  HeldHandle(const ImpedanceDeviceConfig& device, const AttachedHand& hand);

  double viscous_, coulomb_;
  AttachedHand hand_;
  HandleState handle_;
  Vec3 origin_ = Vec3::Zero();  ///< position of the handle at the sample [m]
  Vec3 push_ = Vec3::Zero();    ///< force of the hand on a handle at rest there [N]
  DeviceEnergy work_;           ///< `stored`: minus what was at the reset
};

/// A handle with friction under held forces, in each axis separately and without discretisation error:
///
///   m x'' = f - b x' - c sign(x') + f_hand
///
/// with m = handle_mass, b = viscous, c = coulomb of the device. Coulomb friction is exact: the closed form gives the
/// instant at which the handle stops. There it sticks while the other forces sum up to at most c, and otherwise leaves
/// in their direction. A step has at most 2 + w T / pi stops, w the angular frequency of a hand with a spring.
class HandleMotion : public HeldHandle {
 public:
  HandleMotion(const ImpedanceDeviceConfig& device, const AttachedHand& hand);

  /// Law of the motion between stops; `advance` takes the free_motion of it.
  const MotionLaw& law() const noexcept { return law_; }

  void reset(const HandleState& handle) noexcept;
  /// Advances by `stretch.time` under a constant force of the motors [N]. Allocates nothing.
  void advance(const Vec3& motors, const FreeMotion& stretch) noexcept;

  /// Energy of the handle without the mass of a fixed hand, whose inertia is part of the hand's work.
  DeviceEnergy energy() const noexcept { return work_.plus_stored(stored()); }

 private:
  void advance_with_friction(Eigen::Index axis, double motors, const FreeMotion& stretch) noexcept;
  double hand_at_rest(Eigen::Index axis) const noexcept;
  double stored() const noexcept { return 0.5 * handle_mass_ * handle_.velocity.squaredNorm(); }
  void move(Eigen::Index axis, double motors, double friction, const FreeMotion& by) noexcept;

  double handle_mass_;
  double mass_;  ///< handle and hand [kg]
  MotionLaw law_;
};

/// An elastic transmission of an impedance device: a spring and a damper between its motors and its handle.
struct Transmission {
  double motor_share = 0.5;   ///< of the device's mass on the motors' side, between 0 and 1
  double stiffness = 10'000;  ///< k [N/m]
  double damping = 1.0;       ///< d [N s/m]
};

/// Motors and handle as two masses on an elastic transmission under held forces, in each axis separately and without
/// discretisation error:
///
///   m_m x_m'' = f - b x_m' - c sign(x_m') - k (x_m - x_h) - d (x_m' - x_h')
///   m_h x_h'' = f_hand                    + k (x_m - x_h) + d (x_m' - x_h')
///
/// with m_m = motor_share handle_mass and m_h the rest of it. Friction acts on the motors' side, f_hand on the handle,
/// as in HandleMotion. With Coulomb friction the motors stop, stick while the other forces sum up to at most c, and
/// leave. No closed form gives these instants; they are located to rounding between points a quarter radian of the
/// fastest motion apart, so that two of them within such a piece may be overlooked.
class ElasticMotion : public HeldHandle {
 public:
  /// (x_m, v_m, x_h, v_h, forces on motors and handle), positions relative to the handle's at the sample.
  using State = Eigen::Matrix<double, 6, 1>;
  using Matrix = Eigen::Matrix<double, 6, 6>;

  /// The exact solution after a time: the map of the state, and as forms of it the energies [J] that viscous friction
  /// and the damper take, and that the hand's damper does.
  struct Piece {
    Matrix map, dissipated, hand;
  };
  /// A time, halved again and again, with moving and with sticking motors. Takes about a millisecond to make.
  struct Stretch {
    std::vector<Piece> moving, sticking;
    std::size_t first = 0;  ///< the longest piece within which motors are not looked at
  };

  ElasticMotion(const ImpedanceDeviceConfig& device, const Transmission& transmission, const AttachedHand& hand);

  Stretch stretch(double time) const;

  void reset(const HandleState& handle) noexcept;
  /// Advances by the stretch's time under a constant force of the motors [N]. Allocates nothing.
  void advance(const Vec3& motors, const Stretch& stretch) noexcept;

  /// The motors' side, which the encoder measures.
  const HandleState& motor() const noexcept { return motor_; }
  /// As HandleMotion::energy; `stored` counts both masses and the spring.
  DeviceEnergy energy() const noexcept { return work_.plus_stored(stored()); }

 private:
  enum : Eigen::Index { kMotor, kMotorSpeed, kHandle, kHandleSpeed, kForce, kPush };  ///< of the state

  /// One axis under the force of the motors [N].
  struct Axis {
    State z;
    double motors;
    double friction = 0.0;  ///< on the motors [N]; 0 while they stick
    bool sticks = false;
  };

  Matrix rates(bool sticking) const;
  void start(Axis& axis, bool may_stick) const noexcept;
  bool changes(const Axis& axis, const State& next) const noexcept;
  double on_resting_motors(const Axis& axis, const State& z) const noexcept;
  void take(Axis& axis, const Piece& piece) noexcept;
  double advance_to_change(Axis& axis, const Stretch& stretch, double left, std::size_t skip) noexcept;
  double stored() const noexcept;

  Transmission transmission_;
  double motor_mass_, handle_mass_;  ///< without the hand's [kg]
  HandleState motor_;
};

/// One axis of an impedance device in open loop, as HandleMotion moves it: m x'' = u(t - delay) + offset - b x' - c
/// sign(x').
struct LoggedHandle {
  double mass = 1.0;      ///< m, of all that moves [kg]
  double viscous = 0.0;   ///< b [N s/m]
  double coulomb = 0.0;   ///< c [N]
  double delay = 0.0;     ///< from a row of the log to its force [s]
  double offset = 0.0;    ///< a constant force besides the commands [N]
  double velocity = 0.0;  ///< at the first time [m/s]
};

/// Simulates a log: the positions [m] at `times` [s] of a handle that starts at 0, under forces [N] that are commanded
/// at these times, arrive late and are held; before the first arrives there is none. Exact, stops and rests included.
/// Precondition: times increase, and there are as many forces, times and positions. Takes 20 ns for each time.
void simulate_log(const LoggedHandle& handle, std::span<const double> times, std::span<const double> forces,
                  std::span<double> positions) noexcept;

}  // namespace hapbench
