#pragma once

#include "sim/loop/force_algorithm.hpp"
#include "sim/tool/tool_state.hpp"

/// Integrators that solve for the velocity at the end of the step with the force taken linear in between:
/// f(p + dp, v + dv) = f - K dp - D dv, K and D from the algorithm's Jacobian (K S; B S and friction). One 3x3 solve
/// and the row's force alone: no other evaluation. They foresee no contact that is not there at the row, no change of
/// S, no turn of the tool and no force limit. Where D drives instead of holding (friction on a law whose S exceeds 1)
/// those directions are taken as leapfrog takes them.
namespace hapbench {

/// (M I + dt D + dt^2 K) dv = dt (f - dt K v);  v += dv,  p += dt v.
/// Order 1. On springs and dampers it is the backward Euler method: stable for every K, B and dt; an undamped spring
/// loses the share k / (1 + k), k = K dt^2 / M, of its energy in every step, so that stiff springs come to rest at
/// once.
void implicit_euler(ToolState& tool, const Vec3& force, const ForceJacobian& jacobian, double mass, double dt) noexcept;

/// (M I + dt/2 D + dt^2/4 K) dv = dt (f - dt/2 K v);  p += dt (v + dv/2),  v += dv.
/// Order 2. On springs and dampers it is the implicit midpoint rule (also the trapezoidal one): stable for every K, B
/// and dt; undamped springs keep their energy to rounding. What is much stiffer than M / dt^2 is not damped but changes
/// its sign from step to step.
void implicit_midpoint(ToolState& tool, const Vec3& force, const ForceJacobian& jacobian, double mass,
                       double dt) noexcept;

}  // namespace hapbench
