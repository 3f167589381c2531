#include "scenarios/run/assemble.hpp"

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "device_model/ideal_device.hpp"
#include "device_model/scripted_hands.hpp"
#include "scenarios/files/mesh_file.hpp"
#include "scenarios/files/motion_file.hpp"
#include "scenarios/files/shell_file.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "sim/contact/spring_query.hpp"
#include "sim/core/random.hpp"
#include "sim/environment/marching_cubes.hpp"

namespace hapbench {
namespace {

template <class... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};

SpringSet make_springs(const SpringsEnvironment& fields, std::uint64_t seed) {
  SpringSet springs;
  springs.bilateral = fields.bilateral;
  for (const SpringGroup& group : fields.groups) {
    const double length = group.direction.norm();
    // Unit to rounding is left alone: dividing would change last digits.
    const Vec3 unit = std::abs(length - 1.0) <= 1e-12 ? group.direction : Vec3(group.direction / length);
    springs.gradients.insert(springs.gradients.end(), static_cast<std::size_t>(group.count), unit);
  }
  Random random(seed);
  for (std::int64_t i = 0; i < fields.random.count; ++i) {
    springs.gradients.push_back(fields.random.planar ? random.direction_in_plane() : random.direction());
  }
  return springs;
}

/// The vertices of the surface of the density field, in the order that the contact search likes best.
std::vector<SurfacePoint> block_points(const BlockEnvironment& environment) {
  const BlockWithHole& block = environment.block;
  DensityField field;
  field.signed_distance = [&block](const Vec3& point) { return signed_distance(block, point); };
  field.min = {-block.size.x() / 2, -block.size.y() / 2, -block.size.z()};
  field.max = {block.size.x() / 2, block.size.y() / 2, 0.0};
  field.spacing = environment.grid;
  field.density = environment.density == "binary" ? Density::binary : Density::signed_distance;
  return in_grid_order(vertices_with_normals(marching_cubes(field)), environment.grid);
}

std::vector<SurfacePoint> mesh_points(const Scenario& scenario, const MeshEnvironment& mesh) {
  return in_grid_order(read_mesh_points(resolve_path(scenario, mesh.file), {mesh.scale, mesh.spacing}),
                       mesh.grid.value_or(0.0));
}

/// Edge of the grid cells the local average merges in.
double cell_size(const Environment& environment) {
  return std::visit(Overloaded{[](const SpringsEnvironment&) { return 0.0; },
                               [](const PointShellEnvironment& shell) { return shell.grid.value_or(0.0); },
                               [](const MeshEnvironment& mesh) { return mesh.grid.value_or(0.0); },
                               [](const BlockEnvironment& block) { return block.grid; },
                               [](const auto& analytic) { return analytic.spacing; }},
                    environment);
}

Tool make_tool(const ToolFields& fields) {
  return {*fields.diameter / 2.0, *fields.length, *fields.tip == "round" ? Tip::round : Tip::flat};
}

std::unique_ptr<Motion> make_motion(const Scenario& scenario) {
  if (const auto* recorded = std::get_if<RecordedPosition>(&scenario.motion.position)) {
    return std::make_unique<RecordedMotion>(read_motion(resolve_path(scenario, recorded->file)));
  }
  const OrientationFields& fields = *scenario.motion.orientation;
  Orientation orientation{fields.up->normalized(), fields.lean.normalized(), fields.tilt, fields.azimuth};
  std::optional<std::array<Profile, 3>> position;
  if (const auto* prescribed = std::get_if<PrescribedPosition>(&scenario.motion.position)) {
    position = prescribed->coordinates;
  }
  return std::make_unique<ScriptedMotion>(std::move(orientation), std::move(position));
}

std::unique_ptr<Hand> make_hand(const HandFields& fields) {
  return std::visit(Overloaded{[](const NoHandFields&) -> std::unique_ptr<Hand> { return std::make_unique<NoHand>(); },
                               [](const ForceHandFields& f) -> std::unique_ptr<Hand> {
                                 return std::make_unique<ForceHand>(f.force);
                               }},
                    fields);
}

std::unique_ptr<Device> make_device(const DeviceFields& fields) {
  return std::make_unique<IdealDevice>(std::get<IdealDeviceFields>(fields).force_limit);
}

RenderingConfig rendering_config(const RenderingFields& fields) {
  RenderingConfig config = fields.config;
  config.depth_model = *fields.depth_model;
  config.reduction = *fields.reduction;
  config.mass = *fields.mass;
  config.mu_s = *fields.mu_s;
  config.mu_f = *fields.mu_f;
  return config;
}

bool contains(const std::vector<std::string>& list, const char* name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

}  // namespace

std::vector<SurfacePoint> environment_points(const Scenario& scenario) {
  return std::visit(
      Overloaded{[](const SpringsEnvironment&) { return std::vector<SurfacePoint>{}; },
                 [&](const PointShellEnvironment& s) { return read_point_shell(resolve_path(scenario, s.file)); },
                 [&](const MeshEnvironment& mesh) { return mesh_points(scenario, mesh); },
                 [](const BlockEnvironment& block) { return block_points(block); },
                 [](const auto& analytic) { return surface_points(analytic); }},
      scenario.environment);
}

std::vector<std::string> check_named_files(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  std::vector<std::string> warnings;
  const auto at = [&loaded](const char* pointer, auto read) {
    try {
      read();
    } catch (const InputError& error) {
      throw InputError(InputError::Kind::relation, loaded.file.string() + ": " + pointer, error.what());
    }
  };
  if (std::holds_alternative<PointShellEnvironment>(scenario.environment)) {
    at("/environment/file", [&] { environment_points(scenario); });
  }
  if (const auto* mesh = std::get_if<MeshEnvironment>(&scenario.environment)) {
    const MeshSampling sampling{mesh->scale, mesh->spacing};
    at("/environment/file", [&] { warnings = mesh_warnings(resolve_path(scenario, mesh->file), sampling); });
    for (std::string& warning : warnings) warning = loaded.file.string() + ": /environment/file: " + warning;
  }
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position)) {
    at("/motion/position/file", [&] { make_motion(scenario); });
  }
  return warnings;
}

SimulationConfig simulation_config(const Scenario& scenario) {
  SimulationConfig config;
  config.dt = scenario.time.step;
  config.steps = static_cast<std::uint64_t>(*scenario.time.steps);
  config.mass = *scenario.rendering.mass;
  config.position = scenario.initial.position;
  config.velocity = scenario.initial.velocity;
  if (scenario.motion.orientation) config.up = scenario.motion.orientation->up->normalized();
  config.stop_when_leaves_hole = contains(scenario.time.stop_when, "leaves_hole");
  config.stop_when_horizontal = contains(scenario.time.stop_when, "tool_horizontal");
  config.bounds = scenario.bounds;
  return config;
}

SimulationParts assemble(const Scenario& scenario) {
  SimulationParts parts;
  parts.tool = make_tool(scenario.tool);
  if (const auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment)) {
    parts.query = std::make_unique<SpringQuery>(make_springs(*springs, static_cast<std::uint64_t>(scenario.seed)));
  } else {
    parts.shell = std::make_shared<const PointShell>(environment_points(scenario), cell_size(scenario.environment));
    parts.query = std::make_unique<NeighbourListQuery>(*parts.shell, parts.tool);
  }
  parts.algorithm = make_algorithm(rendering_config(scenario.rendering));
  parts.motion = make_motion(scenario);
  parts.hand = make_hand(scenario.hand);
  parts.device = make_device(scenario.device);
  return parts;
}

}  // namespace hapbench
