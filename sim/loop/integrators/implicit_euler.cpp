#include "sim/loop/integrators/linearly_implicit.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// (M I + dt D + dt^2 K) dv = dt (f - dt K v);  v += dv,  p += dt v.
/// Order 1. On springs and dampers it is the backward Euler method: stable for every K, B and dt; an undamped spring
/// loses the share k / (1 + k), k = K dt^2 / M, of its energy in every step, so that stiff springs come to rest at
/// once.
class ImplicitEuler final : public Integrator {
 public:
  void step(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept override {
    const auto [K, D] = field.jacobian();
    tool.velocity += velocity_change(dt * D + dt * dt * K, dt * (force - dt * (K * tool.velocity)), mass);
    tool.pose.position += dt * tool.velocity;
  }
};

}  // namespace

const IntegratorEntry kImplicitEuler = {
    .info = {.name = "implicit_euler",
             .summary = "linearly implicit Euler: order 1, never unstable on springs, one force and one 3x3 solve a "
                        "step",
             .formula = "(M I + dt D + dt^2 K S) dv = dt (f - dt K S v); v += dv; p += v dt",
             .source = "J. C. Butcher, Numerical Methods for Ordinary Differential Equations; D. Baraff and A. Witkin "
                       "1998",
             .known_failure = "takes energy out of every oscillation, all of it where K dt^2 / M is large; sees no "
                              "contact before it is there"},
    .make = []() -> std::unique_ptr<Integrator> { return std::make_unique<ImplicitEuler>(); },
    .stability_limit = no_stability_limit,
};

}  // namespace hapbench
