#pragma once

#include <optional>

#include "algorithms/registry.hpp"
#include "scenarios/description/scenario.hpp"

/// What is left of K where no contact normal points: the way out of a wedge.
namespace hapbench {

/// Closed form for a wedge with as many points on either face, all equally deep. None for algorithms that have none
/// and for K = 0. The formulas are in the files of the algorithms.
std::optional<WedgeStiffness> wedge_stiffness(const RenderingConfig& config, double half_angle, double points_per_face);

/// A springs scenario with two groups of as many springs each, turned into the faces of a wedge. Throws InputError for
/// other scenarios.
Scenario with_wedge(Scenario scenario, double half_angle);

}  // namespace hapbench
