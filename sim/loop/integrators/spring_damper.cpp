#include <Eigen/LU>
#include <cmath>

#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// The force of the spring-damper plus a force held over the step.
class LinearForce final : public ForceField {
 public:
  LinearForce(const SpringDamper& s, const Vec3& held)
      : jacobian_{s.lambda * s.K * Mat3::Identity(), s.lambda * s.B * Mat3::Identity()}, held_(held) {}

  Vec3 force_at(double, const Vec3& position, const Vec3& velocity) noexcept override {
    return held_ - jacobian_.stiffness * position - jacobian_.damping * velocity;
  }
  ForceJacobian jacobian() const noexcept override { return jacobian_; }

 private:
  ForceJacobian jacobian_;
  Vec3 held_;
};

/// The result of one step from (x, v) with a held force [N].
Eigen::Vector2d stepped(const SpringDamper& s, double x, double v, double held) {
  LinearForce field(s, held * Vec3::UnitX());
  ToolState tool;
  tool.pose.position = x * Vec3::UnitX();
  tool.velocity = v * Vec3::UnitX();
  const Vec3 force = field.force_at(0.0, tool.pose.position, tool.velocity);
  s.integrator->make({})->step(tool, force, s.M, s.dt, field);
  return {tool.pose.position.x(), tool.velocity.x()};
}

}  // namespace

Eigen::Matrix2d SpringDamper::step_matrix() const {
  if (integrator->step_matrix != nullptr) return integrator->step_matrix(*this);
  Eigen::Matrix2d A;
  A << stepped(*this, 1.0, 0.0, 0.0), stepped(*this, 0.0, 1.0, 0.0);
  return A;
}

Eigen::Vector2d SpringDamper::input_step() const {
  return stepped(*this, 0.0, 0.0, 1.0);
}

bool SpringDamper::is_stable() const {
  constexpr double kRounding = 1e-12;
  const Eigen::Matrix2d A = step_matrix();
  const double trace = A.trace(), determinant = A.determinant();
  return std::abs(determinant) <= 1.0 + kRounding && std::abs(trace) <= 1.0 + determinant + kRounding;
}

std::optional<double> SpringDamper::margin() const {
  if (integrator->stability_margin == nullptr) return std::nullopt;
  return integrator->stability_margin(*this);
}

}  // namespace hapbench
