#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/loop/integrators/table.hpp"

/// The linear loop of a scenario: tool, device, hand and the springs of its wall, while nothing saturates and contact
/// lasts. Along a direction in which the springs' tensor S has the eigenvalue lambda they act as one spring lambda K
/// with one damper lambda B, and a step is stable while no eigenvalue of its map leaves the unit circle.
namespace hapbench {

/// True for bilateral springs without viscous friction, limits and stages, on a tool that is free to move: their loop
/// does not depend on the run. Elsewhere contacts come and go.
bool springs_stay(const Scenario& scenario);

/// True for a device that is part of the loop, and not ideal.
inline bool has_device(const Scenario& scenario) {
  return !std::holds_alternative<IdealDeviceFields>(scenario.device);
}

/// The eigenvalues of such a scenario's stiffness tensor S under its algorithm, in units of K, the largest last.
Vec3 stiffness_eigenvalues(Scenario scenario);

/// The tool along a direction in which the stiffness of the scenario's springs is lambda K, without a device.
SpringDamper tool_on_spring(const Scenario& scenario, double lambda);

/// The loop along a direction of the eigenvalue lambda, at a wall of lambda K, lambda B. Precondition: has_device.
DeviceLoop device_loop(const Scenario& scenario, double lambda);

/// The fields of the device that are not at their defaults and that no theory knows, as "device.viscous_N_s_per_m";
/// empty when there are none. Precondition: has_device.
std::string unknown_to_theory(const Scenario& scenario);

/// The delay of the device's force, or of its servo [samples], and the field that sets it.
double delay_of(const Scenario& scenario);
inline const char* delay_path(const Scenario& scenario) {
  const bool has_servo = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
  return has_servo ? "device.servo.delay_samples" : "device.delay_samples";
}

/// The map of a step of the tool at a wall of lambda K and lambda B: by the device's loop, of an ideal device by the
/// integrator alone. Empty for a loop that is too large to solve, and for fields that are unknown_to_theory.
Eigen::MatrixXd contact_step(const Scenario& scenario, double lambda);

/// The maps of a step of device, hand and a wall of lambda K (contact_step), by the name of the hand, empty for the
/// scene's own: with `over_hands`, on an impedance device that a hand holds, also of hand_family(), and with dry
/// friction of the tool which it holds. Empty where there is no contact_step.
std::vector<std::pair<std::string, Eigen::MatrixXd>> contact_loops(const Scenario& scenario, double lambda,
                                                                   bool over_hands);

}  // namespace hapbench
