#pragma once

#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// One step of the integrator the thesis calls leapfrog (Eq. A.1; it is semi-implicit, symplectic Euler):
/// v += (force / mass) dt, then p += v dt. Units: N, kg, s. Stable on one spring-damper (K, B) while
/// 4 - 2 B dt / M - K dt^2 / M > 0.
inline void leapfrog(ToolState& tool, const Vec3& force, double mass, double dt) noexcept {
  tool.velocity += force / mass * dt;
  tool.pose.position += tool.velocity * dt;
}

}  // namespace hapbench
