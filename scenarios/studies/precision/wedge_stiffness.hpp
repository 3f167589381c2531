#pragma once

#include <optional>

#include "scenarios/description/scenario.hpp"

/// What is left of K where no contact normal points: the way out of a wedge. Two faces stand at the half angle w
/// [rad], 0 < w < pi/2, from the wedge's middle plane; the way out is +y, across is x. The contact gradients
/// (+-cos w, -sin w, 0) have the inner product -cos 2w.
namespace hapbench {

/// Stiffness in two directions, in units of K; both are axes of the tensor.
struct WedgeStiffness {
  double along = 0.0;   ///< the way out
  double across = 0.0;  ///< from face to face
};

/// Closed form for a wedge with as many points on either face, all equally deep. None for algorithms that have none
/// here. The formulas are in wedge_stiffness.cpp.
std::optional<WedgeStiffness> wedge_stiffness(const RenderingConfig& config, double half_angle, double points_per_face);

/// A springs scenario with two groups of as many springs each, turned into the faces of a wedge. Throws InputError for
/// other scenarios.
Scenario with_wedge(Scenario scenario, double half_angle);

}  // namespace hapbench
