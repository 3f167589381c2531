#include "sim/loop/integrators/linearly_implicit.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// (M I + dt/2 D + dt^2/4 K) dv = dt (f - dt/2 K v);  p += dt (v + dv/2),  v += dv.
/// Order 2. On springs and dampers it is the implicit midpoint rule (also the trapezoidal one): stable for every K, B
/// and dt; undamped springs keep their energy to rounding. What is much stiffer than M / dt^2 is not damped but changes
/// its sign from step to step.
class ImplicitMidpoint final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const auto [K, D] = field.jacobian();
    const double half = 0.5 * dt;
    const Vec3 change = velocity_change(half * D + half * half * K, dt * (force - half * (K * tool.velocity)), mass);
    tool.pose.position += dt * (tool.velocity + 0.5 * change);
    tool.velocity += change;
  }
};

}  // namespace

const IntegratorEntry kImplicitMidpoint = {
    .info = {.name = "implicit_midpoint",
             .summary = "linearly implicit midpoint rule: order 2, never unstable on springs, one force and one 3x3 "
                        "solve a step",
             .formula = "(M I + dt/2 D + dt^2/4 K S) dv = dt (f - dt/2 K S v); p += dt (v + dv/2); v += dv",
             .source = "J. C. Butcher, Numerical Methods for Ordinary Differential Equations",
             .known_failure = "keeps the energy of undamped springs, so springs much stiffer than M / dt^2 swing from "
                              "step to step; sees no contact before it is there"},
    .make = []() -> std::unique_ptr<Integrator> { return std::make_unique<ImplicitMidpoint>(); },
    .order = 2,
    .damped_order = 2,
    .stability_limit = no_stability_limit,
};

}  // namespace hapbench
