#pragma once

#include <optional>

#include "device_model/attached_hand.hpp"
#include "device_model/force_path.hpp"
#include "device_model/handle_motion.hpp"
#include "device_model/velocity_filter.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

/// An impedance display: a light handle with motors, which measures positions and renders forces.
struct ImpedanceDeviceConfig {
  double handle_mass = 0.05;   ///< m, of everything that moves, as felt at the handle [kg]
  double viscous = 0.0;        ///< friction b, each axis [N s/m]
  double coulomb = 0.0;        ///< friction c, each axis [N]
  double encoder_step = 0.0;   ///< q [m]; 0: exact
  double delay_samples = 0.0;  ///< d, from the sample to the force [periods], whole or not
  VelocityFilterConfig velocity_filter;
  std::optional<double> force_max;   ///< norm at which the motors saturate [N]
  double force_step = 0.0;           ///< resolution of each component [N]; 0: exact
  std::optional<double> force_slew;  ///< fastest change of the force, by its norm [N/s]
};

/// The loop of an impedance display (Colgate and Brown, "Factors affecting the Z-width of a haptic display", ICRA 1994;
/// Diolaiti et al., IEEE Transactions on Robotics 22(2), 2006):
///
///   handle -> encoder -> x_k -> filter -> v_k -> f_render(x_k, v_k) -> resolution, saturation, slew -> delay d T
///     -> hold -> motors -> handle <- hand
///
/// There is no virtual mass: the tool is where the encoder says the handle is. x_k is the nearest multiple of q, halves
/// away from zero, in each axis; v_0 = 0. Motors give nothing before the first force arrives, at t = d T; a fraction of
/// d changes the force within the period. Between samples the handle moves exactly (handle_motion.hpp).
///
/// In the energy balance `actuator` is the work of the motors on the handle; f_in is zero, since it drives nothing.
/// Allocates in the constructor only; a step without Coulomb friction takes about 50 ns.
class ImpedanceDevice final : public Device {
 public:
  /// dt: the period T [s]; hand: all zero for one whose force is held from sample to sample.
  ImpedanceDevice(const ImpedanceDeviceConfig& config, double dt, const AttachedHand& hand = {});

  void reset(const ToolState& tool) noexcept override;
  MeasuredForce measure(const Vec3& hand_force) noexcept override { return {hand_force, Vec3::Zero()}; }
  /// Does nothing: it is the handle that moves the tool.
  void advance(const ToolState&, const Vec3&, double) noexcept override {}
  HandleState handle() const noexcept override { return motion_.handle(); }
  std::optional<DeviceEnergy> energy() const noexcept override { return motion_.energy(); }

  bool moves_tool() const noexcept override { return true; }
  void drive(const Vec3& rendered, const Vec3& hand_force) noexcept override;
  HandleState sampled() const noexcept override { return sampled_; }

 private:
  double encoder_step_;
  VelocityFilter filter_;
  ForcePath path_;
  HandleMotion motion_;
  FreeMotion before_, after_;  ///< the two parts of a period
  HandleState sampled_;
};

}  // namespace hapbench
