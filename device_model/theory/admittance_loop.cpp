#include "device_model/theory/admittance_loop.hpp"

#include <Eigen/LU>

namespace hapbench {
namespace {

/// Indices of the state.
enum { kTool, kToolVelocity, kCarriage, kCarriageVelocity, kHandle, kHandleVelocity, kCommands };

/// Carriage and handle after a step: what the implicit midpoint rule (HandleMechanics) makes of (x_c, v_c, x_h, v_h),
/// and, in the last two columns, of constant forces on carriage and handle.
Eigen::Matrix<double, 4, 6> mechanics_step(const HandleMechanicsConfig& m, double dt) {
  const double k = m.structure_stiffness, c = m.structure_damping;
  Eigen::Matrix4d rate;
  rate << 0, 1, 0, 0,                                                                                       //
      -k / m.carriage_mass, -(c + m.friction) / m.carriage_mass, k / m.carriage_mass, c / m.carriage_mass,  //
      0, 0, 0, 1,                                                                                           //
      k / m.handle_mass, c / m.handle_mass, -k / m.handle_mass, -c / m.handle_mass;
  Eigen::Matrix<double, 4, 6> right;
  right.leftCols<4>() = Eigen::Matrix4d::Identity() + 0.5 * dt * rate;
  right.rightCols<2>().setZero();
  right(1, 4) = dt / m.carriage_mass;
  right(3, 5) = dt / m.handle_mass;
  return (Eigen::Matrix4d::Identity() - 0.5 * dt * rate).partialPivLu().solve(right);
}

}  // namespace

Eigen::MatrixXd AdmittanceLoop::state_matrix() const {
  const auto delay = static_cast<Eigen::Index>(servo.delay);
  const Eigen::Index n = kCommands + delay;
  const auto unit = [n](Eigen::Index i) -> Eigen::RowVectorXd { return Eigen::RowVectorXd::Unit(n, i); };

  const Eigen::RowVectorXd hand = -hand_stiffness * unit(kHandle) - hand_damping * unit(kHandleVelocity);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A.block<2, 2>(kTool, kTool) = tool.step_matrix();
  A.middleRows<2>(kTool) += tool.input_step() * hand;

  const Eigen::RowVectorXd command = servo.stiffness * (A.row(kTool) - unit(kCarriage)) +
                                     servo.damping * (A.row(kToolVelocity) - unit(kCarriageVelocity));
  const Eigen::RowVectorXd actuator = delay == 0 ? command : unit(kCommands + delay - 1);
  const auto mechanics_of = mechanics_step(mechanics, tool.dt);
  A.block<4, 4>(kCarriage, kCarriage) = mechanics_of.leftCols<4>();
  A.middleRows<4>(kCarriage) += mechanics_of.col(4) * actuator + mechanics_of.col(5) * hand;

  for (Eigen::Index i = 0; i < delay; ++i) A.row(kCommands + i) = i == 0 ? command : unit(kCommands + i - 1);

  Eigen::VectorXd scale = Eigen::VectorXd::Ones(n);
  for (const Eigen::Index velocity : {kToolVelocity, kCarriageVelocity, kHandleVelocity}) scale[velocity] = tool.dt;
  scale.tail(delay).setConstant(tool.dt * tool.dt / tool.M);
  return scale.asDiagonal() * A * scale.cwiseInverse().asDiagonal();
}

}  // namespace hapbench
