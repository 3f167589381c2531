#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

/// Input force limiting (thesis 2.7, C.4.4): scales the measured force [N] down to the limit, if there is one and its
/// norm exceeds it. Once the hand pushes harder, the virtual tool penetrates no further, which feels infinitely stiff.
inline Vec3 limit_input_force(const Vec3& measured, std::optional<double> limit) noexcept {
  const double length = limit ? measured.norm() : 0.0;
  return !limit || length <= *limit ? measured : Vec3(measured * (*limit / length));
}

/// A device without dynamics: it measures the force of the hand exactly, and its handle is the tool.
class IdealDevice final : public Device {
 public:
  /// force_limit: threshold f_th of the input-force limiter [N]; none: no limit.
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

/// Errors that the force sensor adds to the hand's force (thesis 3.5; the noise is our addition).
struct ForceSensorConfig {
  double weight = 0.7;           ///< weight of the dummy drill, read along `down` [N]
  Vec3 down = {0.0, 0.0, -1.0};  ///< unit vector
  bool compensated = true;       ///< the weight is subtracted before the limiter
  double noise = 0.0;            ///< standard deviation of each component in each sample [N]
  std::uint64_t seed = 1;        ///< seed of the noise

  bool operator==(const ForceSensorConfig&) const = default;
};

/// The force sensor under the handle: f_meas = f_hand + weight + noise.
///
/// The thesis logs f_meas including the weight, and its limit of 2 N acts at 2.7 N of the logged force (3.5, Fig. 6),
/// so the weight must be subtracted first. With `compensated = false`, which is the literal reading of 2.7, the weight
/// pulls the virtual tool down, and the limit acts at 2 N of f_meas.
class ForceSensor {
 public:
  explicit ForceSensor(const ForceSensorConfig& config) : config_(config), random_(config.seed) {}

  void reset() noexcept { random_ = Random(config_.seed); }

  /// f_meas of the next sample [N].
  Vec3 read(const Vec3& hand_force) noexcept {
    Vec3 force = hand_force + config_.weight * config_.down;
    if (config_.noise > 0.0) {
      for (double& component : force) component += config_.noise * random_.normal();
    }
    return force;
  }

  /// The part of a reading that drives the virtual mass, before the limiter [N].
  Vec3 compensated(const Vec3& measured) const noexcept {
    return config_.compensated ? Vec3(measured - config_.weight * config_.down) : measured;
  }

 private:
  ForceSensorConfig config_;
  Random random_;
};

/// Parameters of the control loop that makes the carriage follow the virtual tool. The thesis gives the saturation
/// (C.4.4); the other values are our choice.
struct PositionServoConfig {
  double stiffness = 40000.0;  ///< force per position error [N/m]
  double damping = 160.0;      ///< force per velocity error [N s/m]
  double max_force = 30.0;     ///< the actuators saturate at this norm [N]
  std::size_t delay = 1;       ///< from the command to the force [samples]

  bool operator==(const PositionServoConfig&) const = default;
};

/// A proportional-derivative position servo with saturation and a delay of whole samples. Allocates in the constructor.
class PositionServo {
 public:
  explicit PositionServo(const PositionServoConfig& config)
      : config_(config), commands_(config.delay + 1, Vec3::Zero()) {}

  /// Clears the delay line: the servo starts from rest.
  void reset() noexcept {
    for (Vec3& command : commands_) command.setZero();
    next_ = 0;
  }

  /// Computes the command of this sample and returns the force of the actuators during it [N].
  Vec3 force(const ToolState& reference, const Vec3& position, const Vec3& velocity) noexcept {
    Vec3 command =
        config_.stiffness * (reference.pose.position - position) + config_.damping * (reference.velocity - velocity);
    const double length = command.norm();
    if (length > config_.max_force) command *= config_.max_force / length;
    commands_[next_] = command;
    next_ = (next_ + 1) % commands_.size();
    return commands_[next_];  // the oldest command; without delay, the one just stored
  }

 private:
  PositionServoConfig config_;
  std::vector<Vec3> commands_;
  std::size_t next_ = 0;
};

/// The moving parts of the device: a carriage driven by the actuators and the handle, which an elastic structure
/// connects to it. The thesis gives none of these values; the mass of the handle is that of the weight it compensates
/// (0.7 N).
struct HandleMechanicsConfig {
  double carriage_mass = 0.25;            ///< [kg]
  double handle_mass = 0.07;              ///< [kg]
  double friction = 2.0;                  ///< viscous, on the carriage [N s/m]
  double structure_stiffness = 200000.0;  ///< between carriage and handle, the inverse of the compliance [N/m]
  double structure_damping = 40.0;        ///< between carriage and handle [N s/m]

  bool operator==(const HandleMechanicsConfig&) const = default;
};

/// Two masses connected by a spring and a damper, independently in each axis, integrated by the implicit midpoint rule,
/// which is stable for every step and here keeps the energy balance exactly. Gravity is assumed to be compensated.
class HandleMechanics {
 public:
  explicit HandleMechanics(const HandleMechanicsConfig& config) : config_(config) {}

  /// Places carriage and handle at the tool, with the tool's velocity and the structure unstretched.
  void reset(const ToolState& tool) noexcept {
    carriage_ = handle_ = {tool.pose.position, tool.velocity};
    work_ = {.stored = -stored()};
  }

  /// One step of dt seconds under constant forces of the hand (on the handle) and the actuators (on the carriage) [N].
  void advance(const Vec3& hand, const Vec3& actuator, double dt) noexcept {
    // Midpoint velocities w solve, with the stretch s = x_c - x_h and a = k dt / 2 + c,
    //
    //   (2 m_c / dt + b + a) w_c - a w_h = u - k s + 2 m_c / dt v_c
    //   -a w_c + (2 m_h / dt + a) w_h    = f + k s + 2 m_h / dt v_h
    //
    // in each axis. Then x += w dt and v = 2 w - v.
    const double inertia_c = 2.0 * config_.carriage_mass / dt, inertia_h = 2.0 * config_.handle_mass / dt;
    const double a = config_.structure_stiffness * dt / 2.0 + config_.structure_damping;
    const double cc = inertia_c + config_.friction + a, hh = inertia_h + a;
    const double determinant = cc * hh - a * a;  // positive: a sum of products of positive terms
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
  DeviceEnergy work_;  ///< `stored`: minus what was at the reset
};

struct AdmittanceDeviceConfig {
  ForceSensorConfig sensor;
  std::optional<double> force_limit = 2.0;  ///< f_th of the input-force limiter [N]; none: no limit
  PositionServoConfig servo;
  HandleMechanicsConfig mechanics;
};

/// The trainer's admittance-control device (thesis 2.7, 3.1, Fig. 3, C.5, C.6):
///
///   hand -> sensor -> limiter -> [ virtual mass ] -> position servo -> carriage -> structure -> handle -> hand
///
/// The virtual mass is the simulation's tool; the servo follows it one step behind the force that moved it.
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
