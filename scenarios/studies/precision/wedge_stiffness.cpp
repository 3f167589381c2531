#include "scenarios/studies/precision/wedge_stiffness.hpp"

#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
std::optional<WedgeStiffness> wedge_stiffness(const RenderingConfig& config, double half_angle,
                                              double points_per_face) {
  const AlgorithmEntry* entry = find_algorithm(config.algorithm);
  if (entry == nullptr || entry->theory.wedge_stiffness == nullptr || config.stiffness == 0.0) return std::nullopt;
  return entry->theory.wedge_stiffness(config, half_angle, points_per_face);
}

Scenario with_wedge(Scenario scenario, double half_angle) {
  auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment);
  const bool two_faces = springs != nullptr && springs->random.count == 0 && springs->groups.size() == 2 &&
                         springs->groups[0].count > 0 && springs->groups[0].count == springs->groups[1].count;
  if (!two_faces) {
    throw InputError(InputError::Kind::relation, "/environment",
                     "got no wedge; allowed for this study: springs in two groups of the same count");
  }
  const double c = std::cos(half_angle), s = std::sin(half_angle);
  springs->groups[0].direction = {c, -s, 0.0};
  springs->groups[1].direction = {-c, -s, 0.0};
  return scenario;
}

}  // namespace hapbench
