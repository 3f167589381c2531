#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "device_model/handle_motion.hpp"
#include "device_model/velocity_filter.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

/// An impedance display: a light handle with motors, which measures positions and renders forces.
struct ImpedanceDeviceConfig {
  double handle_mass = 0.05;   ///< m, of everything that moves, as felt at the handle [kg]
  double viscous = 0.0;        ///< friction b of each axis [N s/m]
  double coulomb = 0.0;        ///< friction c of each axis [N]
  double encoder_step = 0.0;   ///< q [m]; 0: exact
  double delay_samples = 0.0;  ///< d, from the sample to the force [periods], whole or fractional
  /// The same [s] where it is known in seconds; who has the period makes delay_samples of it. Nothing here reads it.
  std::optional<double> delay = {};
  VelocityFilterConfig velocity_filter = {};
  std::optional<double> force_max = {};               ///< norm at which the motors saturate [N]
  double force_step = 0.0;                            ///< resolution of each component [N]; 0: exact
  std::optional<double> force_slew = {};              ///< fastest change of the force, by its norm [N/s]
  std::optional<LowPassFilter> position_filter = {};  ///< of the encoder's positions, before they are rendered
  double position_noise = 0.0;                        ///< standard deviation of each axis, before the encoder [m]
  std::uint64_t seed = 0;                             ///< of the noise
  std::optional<Transmission> transmission = {};      ///< elastic, between motors and handle; none: they are one body
};

/// Every component as the nearest multiple of `step`, halves away from zero; `v` itself for the step 0.
Vec3 rounded_to(const Vec3& v, double step) noexcept;

/// Force of the motors over one period: `before` for ForcePath::switch_part of it, `after` for the rest.
struct HeldForce {
  Vec3 before = Vec3::Zero();  ///< [N]
  Vec3 after = Vec3::Zero();   ///< [N]
};

/// The way from a rendered force to the motors: resolution, saturation and slew limit, in this order, then a delay line
/// and a zero-order hold. Allocates in the constructor only.
class ForcePath {
 public:
  /// dt: period T [s].
  ForcePath(const ImpedanceDeviceConfig& config, double dt);

  /// Sets the force to zero everywhere on the way.
  void reset() noexcept;
  /// Takes the force rendered at the beginning of a period [N] and returns the force of the motors during it.
  HeldForce hold(const Vec3& rendered) noexcept;
  /// Fraction of a period after which the motors change their force, in [0, 1): the fraction of the delay.
  double switch_part() const noexcept { return switch_part_; }

 private:
  Vec3 command(const Vec3& rendered) const noexcept;

  double step_;                  ///< [N]
  std::optional<double> max_;    ///< [N]
  std::optional<double> slew_;   ///< [N/s]
  double largest_change_ = 0.0;  ///< per period if the slew is limited [N]
  double switch_part_;
  Vec3 last_ = Vec3::Zero();    ///< command of the last period
  std::vector<Vec3> commands_;  ///< ring of the commands that are on their way
  std::size_t next_ = 0;
};

/// The loop of an impedance display (Colgate and Brown, "Factors affecting the Z-width of a haptic display", ICRA 1994;
/// Diolaiti et al., IEEE Transactions on Robotics 22(2), 2006):
///
///   handle -> noise -> encoder -> x_k -> filter -> v_k -> f_render(x_k, v_k) -> resolution, saturation, slew
///     -> delay d T -> hold -> motors -> handle <- hand
///
/// No virtual mass: the tool is at the measured position of the handle. x_k is the nearest multiple of q,
/// halves away from zero, in each axis, of the position with its noise; a position filter changes the x_k that is
/// rendered, not that of the velocity. v_0 = 0. The motors give no force before the first one arrives, at t = d T; a
/// fraction of d changes the force within the period. Between samples the handle moves exactly (HandleMotion). With an
/// elastic transmission motors and handle are two bodies (ElasticMotion), and x_k is measured at the motors.
///
/// In the energy balance `actuator` is the work of the motors on the handle. f_in is zero because it drives nothing.
/// Allocates in the constructor only; a step without Coulomb friction takes about 50 ns.
class ImpedanceDevice final : public Device {
 public:
  /// dt: period T [s]. hand: zeros for a hand whose force is held from sample to sample.
  ImpedanceDevice(const ImpedanceDeviceConfig& config, double dt, const AttachedHand& hand = {});

  void reset(const ToolState& tool) noexcept override;
  MeasuredForce measure(const Vec3& hand_force) noexcept override { return {hand_force, Vec3::Zero()}; }
  HandleState handle() const noexcept override { return elastic_ ? elastic_->motion.handle() : motion_.handle(); }
  std::optional<DeviceEnergy> energy() const noexcept override {
    return elastic_ ? elastic_->motion.energy() : motion_.energy();
  }

  bool moves_tool() const noexcept override { return true; }
  void drive(const Vec3& rendered, const Vec3& hand_force) noexcept override;
  HandleState sampled() const noexcept override { return sampled_; }

 private:
  /// The encoder's position.
  Vec3 read_position() noexcept;

  double encoder_step_;
  VelocityFilter filter_;
  std::optional<SampledLowPass> position_filter_;
  double noise_;
  std::uint64_t seed_;
  Random random_;
  ForcePath path_;
  HandleMotion motion_;
  FreeMotion before_, after_;  ///< the two parts of a period
  struct Elastic {
    ElasticMotion motion;
    ElasticMotion::Stretch before, after;
  };
  std::optional<Elastic> elastic_;  ///< instead of motion_
  HandleState sampled_;
};

}  // namespace hapbench
