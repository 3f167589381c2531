#pragma once

#include <limits>
#include <optional>

#include "sim/core/types.hpp"
#include "sim/loop/integrators/table.hpp"

/// What integrators share that solve for the velocity at the end of the step with the force taken linear in between:
/// f(p + dp, v + dv) = f - K dp - D dv, K and D from the algorithm's Jacobian (K S; B S and friction). One 3x3 solve
/// and the row's force alone: no other evaluation. They foresee no contact that is not there at the row, no change of
/// S, no turn of the tool and no force limit. Where D drives instead of holding (friction on a law whose S exceeds 1)
/// those directions are taken as leapfrog takes them.
namespace hapbench {

/// Solves (M I + resistance) dv = impulse for a symmetric `resistance` [kg], the impulse in N s; finite for finite
/// arguments whose quotients by M are finite.
Vec3 velocity_change(const Mat3& resistance, const Vec3& impulse, double mass) noexcept;

/// On springs they are stable at every stiffness, damping and time step.
inline std::optional<double> no_stability_limit(const RaisedSpringDamper&) {
  return std::numeric_limits<double>::infinity();
}

}  // namespace hapbench
