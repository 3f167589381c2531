#include "scenarios/studies/stability/spring_damper.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

/// The force of the spring-damper, in x alone.
class LinearForce final : public ForceField {
 public:
  explicit LinearForce(const SpringDamper& s)
      : jacobian_{s.lambda * s.K * Mat3::Identity(), s.lambda * s.B * Mat3::Identity()} {}

  Vec3 force_at(double, const Vec3& position, const Vec3& velocity) noexcept override {
    return -jacobian_.stiffness * position - jacobian_.damping * velocity;
  }
  ForceJacobian jacobian() const noexcept override { return jacobian_; }

 private:
  ForceJacobian jacobian_;
};

}  // namespace

Eigen::Matrix2d SpringDamper::step_matrix() const {
  Eigen::Matrix2d A;
  if (integrator == Integrator::leapfrog) {
    const double k = lambda * K * dt / M, b = lambda * B * dt / M;
    A << 1.0 - k * dt, dt - b * dt, -k, 1.0 - b;
    return A;
  }
  LinearForce field(*this);
  for (const int column : {0, 1}) {
    ToolState tool;
    (column == 0 ? tool.pose.position : tool.velocity) = Vec3::UnitX();
    const Vec3 force = field.force_at(0.0, tool.pose.position, tool.velocity);
    integrate(integrator, tool, force, M, dt, field);
    A.col(column) << tool.pose.position.x(), tool.velocity.x();
  }
  return A;
}

std::pair<std::complex<double>, std::complex<double>> SpringDamper::eigenvalues() const {
  const Eigen::Vector2cd values = Eigen::EigenSolver<Eigen::Matrix2d>(step_matrix(), false).eigenvalues();
  return {values[0], values[1]};
}

double SpringDamper::spectral_radius() const {
  const auto [first, second] = eigenvalues();
  return std::max(std::abs(first), std::abs(second));
}

bool SpringDamper::is_stable() const {
  constexpr double kRounding = 1e-12;
  const Eigen::Matrix2d A = step_matrix();
  const double trace = A.trace(), determinant = A.determinant();
  return std::abs(determinant) <= 1.0 + kRounding && std::abs(trace) <= 1.0 + determinant + kRounding;
}

double SpringDamper::margin() const {
  return 4.0 - 2.0 * lambda * B * dt / M - lambda * K * dt * dt / M;
}

}  // namespace hapbench
