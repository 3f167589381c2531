#pragma once

#include <Eigen/Core>

#include "device_model/handle_mechanics.hpp"
#include "device_model/position_servo.hpp"
#include "sim/loop/integrators/spring_damper.hpp"

namespace hapbench {

/// The loop of the admittance device (admittance_device.hpp) at a wall, as a linear system: what it is while neither
/// the limiter of the input nor the servo saturates and the contact lasts. Along one axis. In each step, as in
/// Simulation, the hand's force f = -k x_h - b v_h at the row drives the virtual mass, which the wall holds, and the
/// handle; the servo follows where the mass has come to.
struct AdmittanceLoop {
  SpringDamper tool;  ///< the virtual mass at the wall, with time step and integrator
  PositionServoConfig servo;
  HandleMechanicsConfig mechanics;
  double hand_stiffness = 0.0;  ///< k [N/m]
  double hand_damping = 0.0;    ///< b [N s/m]

  /// The map of the state at one row to that at the next,
  ///   (x, T v of the virtual mass, of the carriage, of the handle, T^2/M of the servo's delayed commands, last first),
  /// T the time step, M the virtual mass; all in metres, so that its eigenvalues are known to rounding.
  Eigen::MatrixXd state_matrix() const;
};

}  // namespace hapbench
