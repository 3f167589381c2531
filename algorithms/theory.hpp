#pragma once

#include <cmath>
#include <cstddef>

#include "algorithms/rendering_config.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Stiffness in a wedge, in units of K; both directions are axes of the tensor. Two faces stand at the half angle w
/// [rad], 0 < w < pi/2, from the wedge's middle plane; the way out is +y, across is x. The contact gradients
/// (+-cos w, -sin w, 0) have the inner product -cos 2w.
struct WedgeStiffness {
  double along = 0.0;   ///< the way out
  double across = 0.0;  ///< from face to face
};

/// What is known of an algorithm on paper; null where nothing is. Each derivation stands beside its algorithm.
struct AlgorithmTheory {
  /// The most |f_spring| / K [m] that n contacts, the deepest of them by `depth` [m], may cause in one step.
  double (*force_bound)(const RenderingConfig& config, const ToolShape& tool, std::size_t n, double depth) = nullptr;
  /// Closed form for a wedge with as many points on either face, all equally deep; for K > 0.
  WedgeStiffness (*wedge_stiffness)(const RenderingConfig& config, double half_angle, double points_per_face) = nullptr;
};

inline constexpr AlgorithmTheory kNoTheory;

/// The wedge under weights that add up to `weight` on either face: S = weight (u1 u1^T + u2 u2^T).
inline WedgeStiffness wedge_of_weight(double weight, double half_angle) {
  return {2.0 * weight * std::pow(std::sin(half_angle), 2), 2.0 * weight * std::pow(std::cos(half_angle), 2)};
}

}  // namespace hapbench
