#include "sim/loop/integrators/spring_damper.hpp"

#include <Eigen/Jacobi>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

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

/// For real eigenvalues one rotation makes the matrix triangular. Eigen's general solver would take seconds to compile.
std::pair<std::complex<double>, std::complex<double>> eigenvalues_of(const Eigen::Matrix2d& A) {
  constexpr double kSmallest = std::numeric_limits<double>::min(), kEpsilon = std::numeric_limits<double>::epsilon();
  const double scale = A.cwiseAbs().maxCoeff();
  if (scale < kSmallest) return {};
  Eigen::Matrix2d T = A / scale;  // so that squares do not overflow
  const double half = 0.5 * (T(0, 0) - T(1, 1)), discriminant = half * half + T(1, 0) * T(0, 1);
  const bool triangular = std::abs(T(1, 0)) <= std::max(kEpsilon * (std::abs(T(0, 0)) + std::abs(T(1, 1))), kSmallest);
  if (!triangular && discriminant < 0.0) {
    T *= scale;
    const double p = 0.5 * (T(0, 0) - T(1, 1));
    const double largest = std::max({std::abs(p), std::abs(T(1, 0)), std::abs(T(0, 1))}), q = p / largest;
    const double imaginary = largest * std::sqrt(std::abs(q * q + (T(1, 0) / largest) * (T(0, 1) / largest)));
    return {{T(1, 1) + p, imaginary}, {T(1, 1) + p, -imaginary}};
  }
  if (!triangular) {
    const double root = std::sqrt(discriminant);
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(half >= 0.0 ? half + root : half - root, T(1, 0));
    T.applyOnTheLeft(0, 1, rotation.adjoint());
    T.applyOnTheRight(0, 1, rotation);
  }
  return {T(0, 0) * scale, T(1, 1) * scale};
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

std::pair<std::complex<double>, std::complex<double>> SpringDamper::eigenvalues() const {
  return eigenvalues_of(step_matrix());
}

double spectral_radius(std::complex<double> a, std::complex<double> b) {
  return std::max(math::hypot(a.real(), a.imag()), math::hypot(b.real(), b.imag()));
}

double SpringDamper::spectral_radius() const {
  const auto [first, second] = eigenvalues();
  return hapbench::spectral_radius(first, second);
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

SpringDamper RaisedSpringDamper::at(double value) const {
  SpringDamper system = given;
  system.B = 0.0;
  const auto damping_of = [&] { return damping.value_or(2.0 * damping_ratio * std::sqrt(system.K * system.M)); };
  switch (raised) {
    case StabilityCase::stiffness_undamped:
      system.K = value;
      break;
    case StabilityCase::damping_alone:
      system.K = 0.0;
      system.B = value;
      break;
    case StabilityCase::stiffness_damped:
      system.K = value;
      system.B = damping_of();
      break;
    case StabilityCase::time_step:
      system.dt = value;
      system.B = damping_of();
      break;
  }
  return system;
}

std::optional<double> limit_of_one_alone(const RaisedSpringDamper& problem, const LimitsAlone& limits) {
  const SpringDamper one = problem.at(1.0);
  if (one.lambda == 0.0 || (one.K == 0.0 && one.B == 0.0)) return std::numeric_limits<double>::infinity();
  if (one.K != 0.0 && one.B != 0.0) return std::nullopt;
  const double spring = limits.spring * one.M / one.lambda, damper = limits.damper * one.M / one.lambda;
  if (problem.raised == StabilityCase::time_step) return one.B == 0.0 ? std::sqrt(spring / one.K) : damper / one.B;
  return one.B == 0.0 ? spring / (one.dt * one.dt) : damper / one.dt;
}

}  // namespace hapbench
