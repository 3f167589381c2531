#include "sim/loop/integrators/spring_damper.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// Velocity Verlet: half a kick with the row's force, drift, half a kick with the force there, which is asked for with
/// the velocity after the first half:
///
///   v_half = v + f/M dt/2,  p += v_half dt,  v = v_half + f(t + dt, p, v_half)/M dt/2
///
/// Order 2 without damping, 1 with it: the damping sees velocities of half a step before. One spring-damper, with
/// k = K dt^2 / M, b = B dt / M and c = 1 - b/2: stable while b < 4 and k (1 + c) < 4 (1 + c^2), that is k < 4 for
/// B = 0 as with leapfrog, and b < 4 for K = 0, twice as far. Undamped springs: symplectic, the energy swings by a
/// share of k/4 about its value and does not drift. Two forces a step, the row's and one more: the next row needs that
/// of the final velocity.
class VelocityVerlet final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const Vec3 half = tool.velocity + force / mass * (0.5 * dt);
    tool.pose.position += half * dt;
    tool.velocity = half + field.force_at(1.0, tool.pose.position, half) / mass * (0.5 * dt);
  }
};

std::optional<double> velocity_verlet_limit(const RaisedSpringDamper& problem) {
  return limit_of_one_alone(problem, {4.0, 4.0});
}

}  // namespace

const IntegratorEntry kVelocityVerlet = {
    .info = {.name = "velocity_verlet",
             .summary = "half a kick, drift, half a kick: order 2 without damping, two forces a step",
             .formula = "v' = v + f/M dt/2; p += v' dt; v = v' + f(p, v')/M dt/2",
             .source = "L. Verlet 1967, W. C. Swope et al. 1982",
             .known_failure = "no stiffer springs than leapfrog without damping, K < 4 M / dt^2; order 1 with damping"},
    .make = []() -> std::unique_ptr<Integrator> { return std::make_unique<VelocityVerlet>(); },
    .order = 2,
    .forces = 2,
    .stability_limit = velocity_verlet_limit,
};

}  // namespace hapbench
