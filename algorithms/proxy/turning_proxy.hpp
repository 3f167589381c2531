#pragma once

#include <memory>

#include "algorithms/rendering_config.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// Returns true if the proxy of `config` turns: if its rotational stiffness is finite.
bool turns(const RenderingConfig& config);

/// Makes a proxy that turns (algorithm `proxy` with a finite rotational stiffness k). The proxy (x, theta) is the pose
/// with the smallest energy K/2 |x - p|^2 + k/2 |Log(phi^T theta)|^2 that keeps every shell point outside of it, phi
/// and p being orientation and force point of the tool (six_dof::ToolEquilibrium). The force is f_spring = K (x - p);
/// the moment of the rotational spring is not rendered.
///
/// `force_point`: distance from the tip centre back to the force point, at which the translational spring acts and
/// about which the proxy turns [m].
///
/// S is the projector-like matrix S = U^T (U U^T + K/k V V^T)^-1 U with the rows u_i and r_i x u_i of the holding
/// points: 0 <= S <= I, and the derivative of the force by p is -K S but for the curvature of the tool. Points inside
/// the proxy leave it as under the proxy that translates, at 40 half widths per second. Where walls leave no room, a
/// pass takes the least-squares compromise.
std::unique_ptr<ForceAlgorithm> make_turning_proxy(const RenderingConfig& config, double force_point);

/// Name of the parameter, in rendering.parameters.proxy.
inline constexpr const char* kRotationalStiffness = "rotational_stiffness_N_m_per_rad";

}  // namespace hapbench
