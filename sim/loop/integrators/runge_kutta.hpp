#pragma once

#include "sim/loop/integrators/integrator.hpp"

namespace hapbench {

/// One step of the classical Runge-Kutta method of order 4 (the axis at t, t + dt/2 and t + dt), the reference where
/// forces are smooth; contacts that come and go within a step, and f_in, which is held, bring it down to order 1.
///
/// Undamped spring: stable while K dt^2 / M < 8; it dissipates there, by a share of (K dt^2 / M)^3 / 72 of the energy
/// in a step. Damper alone: stable while B dt / M < 2.7853. Four forces a step.
inline void rk4(ToolState& tool, const Vec3& force, double mass, double dt, ForceField& field) noexcept {
  const double half = 0.5 * dt;
  const Vec3 p = tool.pose.position, v1 = tool.velocity, a1 = force / mass;
  const Vec3 v2 = v1 + a1 * half, a2 = field.force_at(0.5, p + v1 * half, v2) / mass;
  const Vec3 v3 = v1 + a2 * half, a3 = field.force_at(0.5, p + v2 * half, v3) / mass;
  const Vec3 v4 = v1 + a3 * dt, a4 = field.force_at(1.0, p + v3 * dt, v4) / mass;
  tool.pose.position += (v1 + 2.0 * v2 + 2.0 * v3 + v4) * (dt / 6.0);
  tool.velocity += (a1 + 2.0 * a2 + 2.0 * a3 + a4) * (dt / 6.0);
}

}  // namespace hapbench
