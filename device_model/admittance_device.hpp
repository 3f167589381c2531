#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

/// Input-force limiter (thesis sections 2.7, C.4.4): returns the measured force [N], scaled down to norm `limit` [N] if
/// its norm exceeds `limit`. Without a limit, returns the measured force unchanged. While the limiter acts, a harder
/// push of the hand does not push the virtual tool deeper, so the surface feels infinitely stiff.
inline Vec3 limit_input_force(const Vec3& measured, std::optional<double> limit) noexcept {
  const double length = limit ? measured.norm() : 0.0;
  return !limit || length <= *limit ? measured : Vec3(measured * (*limit / length));
}

/// A device without dynamics. It measures the hand's force exactly, and its handle has the position and velocity of
/// the virtual tool.
class IdealDevice final : public Device {
 public:
  /// `force_limit`: threshold f_th of the input-force limiter [N]; empty: no limit.
  explicit IdealDevice(std::optional<double> force_limit) : force_limit_(force_limit) {}

  void reset(const ToolState& tool) noexcept override { handle_ = {tool.pose.position, tool.velocity}; }
  MeasuredForce measure(const Vec3& hand_force) noexcept override {
    return {hand_force, limit_input_force(hand_force, force_limit_)};
  }
  void advance(const ToolState& tool, const Vec3&, double) noexcept override { reset(tool); }
  const HandleState& handle() const noexcept override { return handle_; }

 private:
  std::optional<double> force_limit_;
  HandleState handle_;
};

/// Parameters of the errors that the force sensor adds to the hand's force (thesis section 3.5; the noise is not in the
/// thesis).
struct ForceSensorConfig {
  double weight = 0.7;           ///< weight of the dummy drill [N]; the sensor measures it along `down`
  Vec3 down = {0.0, 0.0, -1.0};  ///< direction of gravity, unit vector in the world frame
  bool compensated = true;       ///< true if the weight is subtracted before the limiter
  double noise = 0.0;            ///< standard deviation of the noise of each force component [N]; 0: no noise
  std::uint64_t seed = 1;        ///< seed of the noise's random numbers

  bool operator==(const ForceSensorConfig&) const = default;
};

/// The force sensor under the handle: f_meas = f_hand + weight + noise. One instance holds the state of one run.
///
/// With `compensated = true` (default) the weight is subtracted before the limiter: the thesis logs f_meas with the
/// weight included, and its limit of 2 N acts at a logged force of 2.7 N (section 3.5, Fig. 6). With
/// `compensated = false`, the literal meaning of section 2.7 of the thesis, the weight pulls the virtual tool down and
/// the limit acts at f_meas = 2 N.
class ForceSensor {
 public:
  explicit ForceSensor(const ForceSensorConfig& config) : config_(config), random_(config.seed) {}

  /// Restarts the random numbers of the noise.
  void reset() noexcept { random_ = Random(config_.seed); }

  /// Returns f_meas of the next sample [N]. Draws new noise in each call.
  Vec3 read(const Vec3& hand_force) noexcept {
    Vec3 force = hand_force + config_.weight * config_.down;
    if (config_.noise > 0.0) {
      for (double& component : force) component += config_.noise * random_.normal();
    }
    return force;
  }

  /// Returns the force that drives the virtual mass before the limiter [N]: `measured`, minus the weight if the weight
  /// is compensated.
  Vec3 compensated(const Vec3& measured) const noexcept {
    return config_.compensated ? Vec3(measured - config_.weight * config_.down) : measured;
  }

 private:
  ForceSensorConfig config_;
  Random random_;
};

/// Parameters of the control loop that makes the carriage follow the virtual tool. The thesis gives only the saturation
/// (C.4.4); the other values are estimates of this project.
struct PositionServoConfig {
  double stiffness = 40000.0;  ///< proportional gain: force per position error [N/m]
  double damping = 160.0;      ///< derivative gain: force per velocity error [N s/m]
  double max_force = 30.0;     ///< norm of the force at which the actuators saturate [N]
  std::size_t delay = 1;       ///< delay from the servo's command to the actuators' force [samples]

  bool operator==(const PositionServoConfig&) const = default;
};

/// Proportional-derivative position servo with saturation and a delay of whole samples. Allocates only in the
/// constructor.
class PositionServo {
 public:
  explicit PositionServo(const PositionServoConfig& config)
      : config_(config), commands_(config.delay + 1, Vec3::Zero()) {}

  /// Sets all delayed commands to zero: the servo starts from rest.
  void reset() noexcept {
    for (Vec3& command : commands_) command.setZero();
    next_ = 0;
  }

  /// Computes the servo's command for this sample from the state `reference` of the virtual tool, and from `position`
  /// [m] and `velocity` [m/s] of the carriage. Returns the force of the actuators during this sample [N], which is the
  /// command of `delay` samples ago.
  Vec3 force(const ToolState& reference, const Vec3& position, const Vec3& velocity) noexcept {
    Vec3 command =
        config_.stiffness * (reference.pose.position - position) + config_.damping * (reference.velocity - velocity);
    const double length = command.norm();
    if (length > config_.max_force) command *= config_.max_force / length;
    commands_[next_] = command;
    next_ = (next_ + 1) % commands_.size();
    return commands_[next_];  // the oldest command; without delay, the command just stored
  }

 private:
  PositionServoConfig config_;
  std::vector<Vec3> commands_;  ///< ring buffer of the last `delay` + 1 commands [N]
  std::size_t next_ = 0;        ///< index of the slot for the next command
};

/// Moving parts of the device: a carriage that the actuators drive, and the handle. A spring and a damper model the
/// elastic structure between them. The thesis gives none of these values; the handle's mass is the mass whose
/// weight the sensor compensates (0.7 N).
struct HandleMechanicsConfig {
  double carriage_mass = 0.25;  ///< [kg]
  double handle_mass = 0.07;    ///< [kg]
  double friction = 2.0;        ///< viscous friction of the carriage [N s/m]
  /// Stiffness between carriage and handle (the inverse of the compliance) [N/m].
  double structure_stiffness = 200000.0;
  double structure_damping = 40.0;  ///< damping between carriage and handle [N s/m]

  bool operator==(const HandleMechanicsConfig&) const = default;
};

/// Two masses connected by a spring and a damper, independently in each axis. Integrated by the implicit midpoint
/// rule, which is stable for every step size and conserves the energy balance of this linear system exactly.
/// Gravity is assumed to be compensated.
class HandleMechanics {
 public:
  explicit HandleMechanics(const HandleMechanicsConfig& config) : config_(config) {}

  /// Sets carriage and handle to the tool's position and velocity, so the spring is unstretched. Clears the work
  /// sums.
  void reset(const ToolState& tool) noexcept {
    carriage_ = handle_ = {tool.pose.position, tool.velocity};
    work_ = {.stored = -stored()};
  }

  /// Advances by `dt` [s] under constant forces [N]: `hand` acts on the handle, `actuator` on the carriage.
  void advance(const Vec3& hand, const Vec3& actuator, double dt) noexcept {
    // The midpoint velocities w_c (carriage) and w_h (handle) solve, in each axis, with the elongation s = x_c -
    // x_h and a = k dt / 2 + c,
    //
    //   (2 m_c / dt + b + a) w_c - a w_h = u - k s + 2 m_c / dt v_c
    //   -a w_c + (2 m_h / dt + a) w_h    = f + k s + 2 m_h / dt v_h
    //
    // Here m is mass, b friction, k and c stiffness and damping of the structure, u and f the forces of actuators
    // and hand. Then x += w dt and v = 2 w - v.
    const double inertia_c = 2.0 * config_.carriage_mass / dt, inertia_h = 2.0 * config_.handle_mass / dt;
    const double a = config_.structure_stiffness * dt / 2.0 + config_.structure_damping;
    const double cc = inertia_c + config_.friction + a, hh = inertia_h + a;
    const double determinant = cc * hh - a * a;  // positive, because all terms of the expanded product are positive
    const Vec3 tension = config_.structure_stiffness * (carriage_.position - handle_.position);
    const Vec3 right_c = actuator - tension + inertia_c * carriage_.velocity;
    const Vec3 right_h = hand + tension + inertia_h * handle_.velocity;
    const Vec3 w_c = (hh * right_c + a * right_h) / determinant;
    const Vec3 w_h = (a * right_c + cc * right_h) / determinant;

    carriage_ = {carriage_.position + w_c * dt, 2.0 * w_c - carriage_.velocity};
    handle_ = {handle_.position + w_h * dt, 2.0 * w_h - handle_.velocity};
    work_.hand += hand.dot(w_h) * dt;
    work_.actuator += actuator.dot(w_c) * dt;
    work_.dissipated -=
        (config_.friction * w_c.squaredNorm() + config_.structure_damping * (w_c - w_h).squaredNorm()) * dt;
  }

  const HandleState& carriage() const noexcept { return carriage_; }
  const HandleState& handle() const noexcept { return handle_; }
  /// Returns the work of each force since the reset, and the change of the stored energy since the reset [J].
  DeviceEnergy energy() const noexcept { return work_.plus_stored(stored()); }

 private:
  double stored() const noexcept {
    return 0.5 * config_.carriage_mass * carriage_.velocity.squaredNorm() +
           0.5 * config_.handle_mass * handle_.velocity.squaredNorm() +
           0.5 * config_.structure_stiffness * (carriage_.position - handle_.position).squaredNorm();
  }

  HandleMechanicsConfig config_;
  HandleState carriage_;
  HandleState handle_;
  DeviceEnergy work_;  ///< work of each force since the reset; `stored` is minus the energy stored at the reset [J]
};

struct AdmittanceDeviceConfig {
  ForceSensorConfig sensor;
  std::optional<double> force_limit = 2.0;  ///< f_th of the input-force limiter [N]; empty: no limit
  PositionServoConfig servo;
  HandleMechanicsConfig mechanics;
};

/// Admittance-control device of the dental trainer (thesis sections 2.7, 3.1, C.5, C.6, Fig. 3):
///
///   hand -> sensor -> limiter -> [ virtual mass ] -> position servo -> carriage -> structure -> handle -> hand
///
/// The simulation integrates the virtual mass. In each step, the virtual mass moves first. The servo then follows the
/// state of the virtual mass at the end of the step.
class AdmittanceDevice final : public Device {
 public:
  explicit AdmittanceDevice(const AdmittanceDeviceConfig& config)
      : force_limit_(config.force_limit), sensor_(config.sensor), servo_(config.servo), mechanics_(config.mechanics) {}

  void reset(const ToolState& tool) noexcept override {
    sensor_.reset();
    servo_.reset();
    mechanics_.reset(tool);
  }
  MeasuredForce measure(const Vec3& hand_force) noexcept override {
    const Vec3 measured = sensor_.read(hand_force);
    return {measured, limit_input_force(sensor_.compensated(measured), force_limit_)};
  }
  void advance(const ToolState& tool, const Vec3& hand_force, double dt) noexcept override {
    const HandleState& carriage = mechanics_.carriage();
    mechanics_.advance(hand_force, servo_.force(tool, carriage.position, carriage.velocity), dt);
  }
  const HandleState& handle() const noexcept override { return mechanics_.handle(); }
  std::optional<DeviceEnergy> energy() const noexcept override { return mechanics_.energy(); }

 private:
  std::optional<double> force_limit_;
  ForceSensor sensor_;
  PositionServo servo_;
  HandleMechanics mechanics_;
};

}  // namespace hapbench
