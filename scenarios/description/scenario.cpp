#include "scenarios/description/scenario.hpp"

#include "algorithms/registry.hpp"
#include "scenarios/description/descriptions.hpp"

namespace hapbench {

bool records_rows(const RecordFields& record) {
  return record.trajectory || !record.ratio_iterations.empty() || record.contacts || record.stiffness_tensor ||
         record.energy || record.ideal_trajectory || record.force_reference;
}

bool has_ideal_trajectory(const Scenario& scenario) {
  return std::holds_alternative<BlockEnvironment>(scenario.environment) && scenario.tool.tip == Tip::flat;
}

std::filesystem::path resolve_path(const Scenario& scenario, const std::string& file) {
  return scenario.directory / file;  // an absolute `file` replaces the directory
}

Scenario with_algorithm(Scenario scenario, std::string_view algorithm) {
  scenario.rendering.algorithm = algorithm;
  scenario.rendering = with_fixed_stages(scenario.rendering);
  return scenario;
}

void set_scene_defaults(Scenario& scenario) {
  // The structs hold the defaults of springs.
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return;
  RenderingConfig& rendering = scenario.rendering;
  rendering.mu_s = 5.0;
  rendering.mu_f = 10.0;
  if (std::holds_alternative<Hole2d>(scenario.environment)) {
    scenario.tool.length = 0.005;
    scenario.tool.tip = Tip::round;
  } else {
    scenario.motion.orientation->up = {0.0, 0.0, 1.0};
    rendering.mass = 0.1;
  }
}

}  // namespace hapbench
