#include "scenarios/run/assemble.hpp"

#include <algorithm>

#include "algorithms/registry.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/scene/devices.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/hands.hpp"
#include "scenarios/scene/recordings.hpp"
#include "scenarios/scene/tools.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/contact/multi_rate_contacts.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/contact/trace_source.hpp"

namespace hapbench {
namespace {

/// Largest number of contacts that a module may return in one step. The size of the mesh gives no such bound, because a
/// module may compute its contacts without triangles.
constexpr std::size_t kMaxModuleContacts = 10'000;

/// Returns the coordinates or indices of all elements as one contiguous array; null if there are no elements.
template <class Element>
const auto* numbers_in(const std::vector<Element>& elements) {
  return elements.empty() ? nullptr : elements.front().data();
}

std::unique_ptr<ContactSource> make_module_contacts(const Scenario& scenario, const NamedFiles& files) {
  const auto* drill = std::get_if<CylinderFields>(&scenario.tool);
  const bool is_flat = drill != nullptr && drill->tip == Tip::flat;
  const TriangleSoup surface = environment_surface(scenario, files);
  const HapbenchRun run = {.data = nullptr,
                           .stiffness = scenario.rendering.stiffness,
                           .capacity = kMaxModuleContacts,
                           .vertices = numbers_in(surface.vertices),
                           .vertex_count = surface.vertices.size(),
                           .triangles = numbers_in(surface.triangles),
                           .triangle_count = surface.triangles.size(),
                           .tool_radius = make_tool(scenario, files)->half_width(),
                           .tool_length = is_flat ? drill->length : 0.0};
  return module_contacts(scenario.directory / scenario.rendering.contact_file, scenario.rendering.contact_config, run);
}

/// Returns the conditions that end the run early. Their order does not depend on the scenario: the first
/// condition that holds determines the outcome.
std::vector<StopRule> stop_rules(const Scenario& scenario) {
  const auto wants = [&](StopCondition rule) { return std::ranges::count(scenario.time.stop_when, rule) > 0; };
  const Vec3 up = scenario.motion.orientation ? scenario.motion.orientation->up.normalized() : Vec3(0.0, 0.0, 1.0);
  std::vector<StopRule> rules;
  if (wants(StopCondition::leaves_hole)) rules.push_back({Ending::left_hole, up});
  if (wants(StopCondition::tool_horizontal)) rules.push_back({Ending::tool_horizontal, up});
  return rules;
}

}  // namespace

TriangleSoup environment_surface(const Scenario& scenario, const NamedFiles& files) {
  if (std::holds_alternative<MeshEnvironment>(scenario.environment))
    return files.at(kEnvironmentFile).mesh().triangles();
  TriangleSoup surface;
  if (const auto* block = std::get_if<BlockEnvironment>(&scenario.environment)) {
    IsoSurface mesh = marching_cubes(density_field(block->block, block->grid, block->density), {.triangles = true});
    for (const SurfacePoint& vertex : mesh.vertices) surface.vertices.push_back(vertex.position);
    surface.triangles = std::move(mesh.triangles);
  } else {
    const auto shell = make_shell(scenario, files);
    for (std::size_t i = 0; i < shell->size(); ++i) surface.vertices.push_back(shell->point(i).position);
  }
  return surface;
}

SimulationConfig simulation_config(const Scenario& scenario) {
  SimulationConfig config;
  config.skips = scenario.rendering.skips;
  config.dt = scenario.time.step;
  config.steps = static_cast<std::uint64_t>(scenario.time.steps);
  config.mass = scenario.rendering.mass;
  config.integrator = scenario.integrator.type;
  config.event_tolerance = scenario.integrator.tolerance;
  config.position = scenario.initial.position;
  config.velocity = scenario.initial.velocity;
  config.stop_when = stop_rules(scenario);
  config.bounds = scenario.bounds;
  return config;
}

SimulationParts assemble_rendering(const Scenario& scenario, const NamedFiles& files,
                                   std::shared_ptr<const PointShell> shell, Trial trial) {
  SimulationParts parts;
  parts.tool = make_tool(scenario, files);
  parts.shell = std::move(shell);
  const RenderingConfig& rendering = scenario.rendering;
  // A law that finds its contacts itself ignores a trace or a module. The contact source is then the search over the
  // point shell, and the metrics describe the contacts that this search finds.
  const bool finds_contacts = !find_algorithm(rendering.algorithm)->reported_depth_model.empty();
  // Create the contact source: springs, a recorded trace, a module, or the search over the point shell.
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) {
    parts.springs = std::make_shared<const SpringSet>(make_springs(scenario));
    parts.source = std::make_unique<SpringSource>(parts.springs);
  } else if (rendering.contact_source == kTrace && !finds_contacts) {
    parts.source = std::make_unique<TraceSource>(files.at(kContactFile).trace(), scenario.time.step);
  } else if (rendering.contact_source != kComputedContacts && !finds_contacts) {
    parts.source = make_module_contacts(scenario, files);
  } else {
    auto search = make_contact_query(*parts.shell, *parts.tool, rendering.skips);
    parts.source = std::make_unique<ShellSource>(*parts.shell, *parts.tool, std::move(search),
                                                 make_depth_model(rendering), rendering.skips);
  }
  // Multi-rate contacts wrap the source and evaluate it only at some steps.
  if (has_multi_rate_contacts(scenario)) {
    parts.source = std::make_unique<MultiRateContacts>(std::move(parts.source), *rendering.multi_rate,
                                                       parts.springs && parts.springs->bilateral,
                                                       derived_seed(scenario, trial, RandomUse::lost_queries));
  }
  parts.algorithm = make_algorithm(rendering);
  return parts;
}

SimulationParts assemble(const Scenario& scenario, const NamedFiles& files, std::shared_ptr<const PointShell> shell,
                         Trial trial) {
  SimulationParts parts = assemble_rendering(scenario, files, std::move(shell), trial);
  add_hand_and_motion(scenario, files, trial, parts);
  parts.device = make_device(scenario, trial);
  return parts;
}

SimulationParts assemble(const Scenario& scenario) {
  const NamedFiles files(scenario);
  return assemble(scenario, files, make_shell(scenario, files), {});
}

}  // namespace hapbench
