#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/loop/integrators/spring_damper.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// The integrator that the thesis calls leapfrog (Eq. A.1; it is semi-implicit, symplectic Euler):
/// v += (force / mass) dt, then p += v dt. Stable on one spring-damper while 4 - 2 B dt / M - K dt^2 / M > 0.
class Leapfrog final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField&) noexcept override {
    tool.velocity += force / mass * dt;
    tool.pose.position += tool.velocity * dt;
  }
};

/// Eq. A.2.
Eigen::Matrix2d step_matrix(const SpringDamper& s) {
  const double k = s.lambda * s.K * s.dt / s.M, b = s.lambda * s.B * s.dt / s.M;
  Eigen::Matrix2d A;
  A << 1.0 - k * s.dt, s.dt - b * s.dt, -k, 1.0 - b;
  return A;
}

double margin(const SpringDamper& s) {
  return 4.0 - 2.0 * s.lambda * s.B * s.dt / s.M - s.lambda * s.K * s.dt * s.dt / s.M;
}

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Positive root of a x^2 + 2 b x = 4; infinite when there is none.
double positive_root(double a, double b) {
  if (a == 0.0) return b == 0.0 ? kNever : 2.0 / b;
  return 4.0 / (b + std::sqrt(b * b + 4.0 * a));
}

/// Where the margin is zero.
std::optional<double> leapfrog_limit(const RaisedSpringDamper& problem) {
  const double M = problem.given.M, dt = problem.given.dt, lambda = problem.given.lambda;
  if (problem.raised == StabilityCase::time_step) {
    const SpringDamper system = problem.at(dt);
    return positive_root(lambda * system.K / M, lambda * system.B / M);
  }
  if (lambda == 0.0) return kNever;
  if (problem.raised == StabilityCase::stiffness_undamped) return 4.0 * M / (lambda * dt * dt);
  if (problem.raised == StabilityCase::damping_alone) return 2.0 * M / (lambda * dt);
  // With a fixed B the inequality is linear in K, with B = 2 zeta sqrt(K M) quadratic in sqrt K.
  if (problem.damping) {
    return std::max(0.0, (4.0 - 2.0 * lambda * *problem.damping * dt / M) * M / (lambda * dt * dt));
  }
  return std::pow(positive_root(lambda * dt * dt / M, 2.0 * problem.damping_ratio * lambda * dt / std::sqrt(M)), 2);
}

}  // namespace

const IntegratorEntry kLeapfrog = {
    .info = {.name = "leapfrog",
             .summary = "semi-implicit Euler, the thesis's integrator: order 1, one force a step",
             .formula = "v += f/M dt; p += v dt",
             .source = "thesis Eq. A.1",
             .known_failure = "blows up where 4 - 2 B dt / M - K dt^2 / M < 0; the energy of an undamped spring swings "
                              "but does not drift"},
    .make = []() -> std::unique_ptr<Integrator> { return std::make_unique<Leapfrog>(); },
    .holds_force = true,
    .step_matrix = step_matrix,
    .stability_margin = margin,
    .stability_limit = leapfrog_limit,
};

}  // namespace hapbench
