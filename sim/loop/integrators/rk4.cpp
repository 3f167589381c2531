#include "sim/loop/integrators/spring_damper.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// The classical Runge-Kutta method of order 4 (the axis at t, t + dt/2 and t + dt), the reference where forces are
/// smooth; contacts that come and go within a step, and f_in, which is held, bring it down to order 1.
///
/// Undamped spring: stable while K dt^2 / M < 8; it dissipates there, by a share of (K dt^2 / M)^3 / 72 of the energy
/// in a step. Damper alone: stable while B dt / M < 2.7853. Four forces a step.
class Rk4 final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const double half = 0.5 * dt;
    const Vec3 p = tool.pose.position, v1 = tool.velocity, a1 = force / mass;
    const Vec3 v2 = v1 + a1 * half, a2 = field.force_at(0.5, p + v1 * half, v2) / mass;
    const Vec3 v3 = v1 + a2 * half, a3 = field.force_at(0.5, p + v2 * half, v3) / mass;
    const Vec3 v4 = v1 + a3 * dt, a4 = field.force_at(1.0, p + v3 * dt, v4) / mass;
    tool.pose.position += (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (dt / 6.0);
    tool.velocity += (a1 + 2.0 * a2 + 2.0 * a3 + a4) * (dt / 6.0);
  }
};

/// Ends of the stability region |1 + z + z^2/2 + z^3/6 + z^4/24| <= 1 on the imaginary axis, z^2 = -8, and on the real
/// one.
std::optional<double> rk4_limit(const RaisedSpringDamper& problem) {
  return limit_of_one_alone(problem, {8.0, 2.785293563405282});
}

}  // namespace

const IntegratorEntry kRk4 = {
    .info = {.name = "rk4",
             .summary = "classical Runge-Kutta method, the reference on smooth forces: order 4, four forces a step",
             .formula = "v, p += dt/6 (k1 + 2 k2 + 2 k3 + k4)",
             .source = "W. Kutta 1901",
             .known_failure =
                 "blows up at K > 8 M / dt^2; order 1 where contacts come and go within a step; dissipates a little"},
    .make = []() -> std::unique_ptr<Integrator> { return std::make_unique<Rk4>(); },
    .order = 4,
    .damped_order = 4,
    .forces = 4,
    .stability_limit = rk4_limit,
};

}  // namespace hapbench
