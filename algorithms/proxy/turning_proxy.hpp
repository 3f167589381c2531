#pragma once

#include <memory>

#include "algorithms/rendering_config.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// Returns true if the algorithm of `config` is `proxy` with a finite rotational stiffness; the proxy then rotates.
bool turns(const RenderingConfig& config);

/// Creates a proxy that also rotates (algorithm `proxy` with a finite rotational stiffness k [N m/rad]). The tool has
/// the orientation phi and the force point p. The pose (x, theta) of the proxy minimises the energy K/2 |x - p|^2 + k/2
/// |Log(phi^T theta)|^2 among the poses in which every shell point is outside of the proxy (six_dof::ToolEquilibrium).
/// The force is f_spring = K (x - p); the moment of the rotational spring is not rendered.
///
/// `force_point`: distance [m] from the tip centre to the force point, along the tool's axis and away from the tip. The
/// translational spring acts at the force point, and the proxy rotates about the force point.
///
/// S = U^T (U U^T + K/k V V^T)^-1 U with the rows u_i of U and r_i x u_i of V, for the points that hold the proxy. r_i
/// is the vector from the force point to point i. S satisfies 0 <= S <= I. Apart from a term from the curvature of the
/// tool, the derivative of the force with respect to p is -K S. If points are inside the proxy, the proxy moves out at
/// 40 times the half width of the tool per second, as the translating proxy does. If there is no room for the tool
/// between the walls, the proxy takes the pose with the smallest sum of squared penetrations, and S is I.
std::unique_ptr<ForceAlgorithm> make_turning_proxy(const RenderingConfig& config, double force_point);

/// Name of the parameter k in rendering.parameters.proxy.
inline constexpr const char* kRotationalStiffness = "rotational_stiffness_N_m_per_rad";

}  // namespace hapbench
