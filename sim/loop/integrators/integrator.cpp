#include "sim/loop/integrators/integrator.hpp"

#include "sim/loop/integrators/leapfrog.hpp"
#include "sim/loop/integrators/linearly_implicit.hpp"
#include "sim/loop/integrators/runge_kutta.hpp"
#include "sim/loop/integrators/velocity_verlet.hpp"

namespace hapbench {
namespace {

/// In the order of the enumeration.
constexpr std::array<std::string_view, 5> kNames = {"leapfrog", "velocity_verlet", "rk4", "implicit_euler",
                                                    "implicit_midpoint"};
static_assert(kNames.size() == kIntegrators.size());
static_assert(static_cast<std::size_t>(Integrator::implicit_midpoint) == kNames.size() - 1);

}  // namespace

std::string_view integrator_name(Integrator integrator) noexcept {
  return kNames[static_cast<std::size_t>(integrator)];
}

void integrate(Integrator integrator, ToolState& tool, const Vec3& force, double mass, double dt,
               ForceField& field) noexcept {
  switch (integrator) {
    case Integrator::leapfrog:
      return leapfrog(tool, force, mass, dt);
    case Integrator::velocity_verlet:
      return velocity_verlet(tool, force, mass, dt, field);
    case Integrator::rk4:
      return rk4(tool, force, mass, dt, field);
    case Integrator::implicit_euler:
      return implicit_euler(tool, force, field.jacobian(), mass, dt);
    case Integrator::implicit_midpoint:
      return implicit_midpoint(tool, force, field.jacobian(), mass, dt);
  }
}

}  // namespace hapbench
