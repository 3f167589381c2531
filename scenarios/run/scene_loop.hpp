#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/loop/integrators/table.hpp"

/// The linear control loop of a scenario: tool, device, hand and the contact springs, as long as nothing
/// saturates and contact is not lost. Let K be the stiffness, B the damping, and lambda an eigenvalue of the
/// springs' stiffness tensor S (in units of K). Along the direction of lambda, the springs act like one spring
/// lambda K with one damper lambda B. The loop is stable if no eigenvalue of the state matrix of one step
/// leaves the unit circle.
namespace hapbench {

/// Returns true if the springs never lose contact and respond linearly, so that their loop is the same at every
/// step. This holds for bilateral springs without friction, Hunt-Crossley damping, limits, force stages and multi-rate
/// contacts, on a tool that is free to move.
bool has_permanent_springs(const Scenario& scenario);

/// Returns true if the scenario has a device other than the ideal device. Only such a device is part of the
/// loop.
inline bool has_device(const Scenario& scenario) {
  return !std::holds_alternative<IdealDeviceFields>(scenario.device);
}

/// Returns true if the device is part of the tool's loop. An admittance device is not, if the force of the hand does
/// not depend on the handle: the servo then moves only the handle, and the tool moves as with an ideal device.
bool device_acts_on_tool(const Scenario& scenario);

/// Returns the scenario with each of its subjects alone, because each subject closes a loop of its own. Of subjects
/// with equal loops, returns only the first. Returns only the scenario itself if it has no subjects.
std::vector<Scenario> with_each_subject(const Scenario& scenario);

/// Returns the eigenvalues of the stiffness tensor S under the scenario's algorithm, in units of K, in
/// ascending order. Precondition: has_permanent_springs(scenario).
Vec3 stiffness_eigenvalues(Scenario scenario);

/// Returns the tool on a spring of stiffness lambda K and damping lambda B, without a device.
SpringDamper tool_on_spring(const Scenario& scenario, double lambda);

/// Returns the loop of device, hand and a wall with stiffness lambda K and damping lambda B. Precondition:
/// has_device(scenario).
DeviceLoop device_loop(const Scenario& scenario, double lambda);

/// Returns the paths of the device fields that differ from their defaults and that the linear model does not include,
/// such as "device.viscous_N_s_per_m", separated by commas. Empty if there are no such fields. Precondition:
/// has_device(scenario).
std::string unmodelled_fields(const Scenario& scenario);

/// Returns the delay of the device's force, or of the servo of an admittance device [samples]. 0 for an ideal device.
double delay_of(const Scenario& scenario);
/// Returns the path of the field that sets the delay of delay_of().
inline const char* delay_path(const Scenario& scenario) {
  const bool has_servo = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
  return has_servo ? "device.servo.delay_samples" : "device.delay_samples";
}

/// Returns the matrix that maps position and velocity (x, v) of the tool from one step to the next. The tool is on a
/// spring of stiffness lambda K and damping lambda B, without a device. The hand's force is constant during a step.
Eigen::Matrix2d step_matrix_with_hand(const Scenario& scenario, double lambda);

/// Returns true if the linear theory covers the scenario's device: its delay is short enough to compute the loop's
/// eigenvalues, and unmodelled_fields() is empty. True if the device is no part of the loop.
bool has_linear_loop(const Scenario& scenario);

/// Returns the matrices of the scenario's loop of hand, device and contact in three dimensions (contact_loop() in
/// linear_loops.hpp). With dry friction, also returns the matrices of the loop in which friction holds the tool. With
/// several subjects, returns the matrices of the loops of all subjects at the same contact. Empty if has_linear_loop()
/// is false or the loop is too large to solve.
std::vector<Eigen::MatrixXd> contact_loop(const Scenario& scenario, const LinearContact& contact);

/// The matrices of one variant of a loop in contact.
struct NamedLoop {
  std::string name;  ///< empty for the loop of the scenario
  std::vector<Eigen::MatrixXd> matrices;
};

/// Returns the variants of the scenario's loop in contact:
/// - the loop of the scenario, with an empty name;
/// - with dry friction: the loop along the surface while friction holds the tool;
/// - with `over_hands`, if a hand holds an impedance device: the loop with each hand of typical_hands().
/// Omits variants without matrices.
std::vector<NamedLoop> contact_loops(const Scenario& scenario, const LinearContact& contact, bool over_hands);
/// Returns the same variants as contact_loops(), for a tool in permanent contact with a wall that acts along one axis,
/// with stiffness lambda K and damping lambda B.
std::vector<NamedLoop> wall_loops(const Scenario& scenario, double lambda, bool over_hands);

/// Returns the name of the part of the tool's loop that is unstable without contact: "the device's servo" or "the
/// device" if the device is unstable also without a hand, otherwise "hand and device", or "the hand" if the device is
/// no part of the loop. The eigenvalues of the state matrices decide. Empty if the loop without contact is stable, or
/// if has_linear_loop() is false.
std::string unstable_without_wall(const Scenario& scenario);

/// Returns the state matrix of one step of the tool in contact with a wall of stiffness lambda K and damping
/// lambda B. If device_acts_on_tool(), this is the matrix of device_loop(), otherwise step_matrix_with_hand(). Of
/// several subjects, the hand of the first is in the loop. Empty if has_linear_loop() is false.
Eigen::MatrixXd contact_step_matrix(const Scenario& scenario, double lambda);
/// Returns the contact_step_matrix() of each scenario of with_each_subject(). Empty if has_linear_loop() is false.
std::vector<Eigen::MatrixXd> contact_step_matrices(const Scenario& scenario, double lambda);

}  // namespace hapbench
