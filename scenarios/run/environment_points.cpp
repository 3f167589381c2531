#include "scenarios/run/environment_points.hpp"

#include <nlohmann/json.hpp>

#include "results/io/json_text.hpp"
#include "scenarios/input/loaded_code.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/contact/grid_index.hpp"
#include "sim/mesh/block_field.hpp"
#include "sim/mesh/points_by_cell.hpp"

namespace hapbench {
namespace {

/// The vertices of the surface of the density field, in the order that the contact search likes best.
ShellPoints block_points(const BlockEnvironment& environment) {
  const DensityField field = density_field(environment.block, environment.grid, environment.density);
  if (environment.vertices == BlockVertices::shared) {
    return {in_grid_order(vertices_with_normals(marching_cubes(field)), environment.grid), {}};
  }
  CutCells cells;
  const HalfEdgeMesh mesh = marching_cubes(field, &cells);
  return points_by_cell(mesh, cells, environment.grid);
}

/// Builds the points of each type of environment.
struct Build {
  const NamedFiles& files;

  ShellPoints operator()(const SpringsEnvironment&) const { return {}; }
  ShellPoints operator()(const PointShellEnvironment&) const { return {files.shell_points(), {}}; }
  ShellPoints operator()(const MeshEnvironment& mesh) const {
    return {in_grid_order(files.mesh().points(), mesh.grid.value_or(0.0)), {}};
  }
  ShellPoints operator()(const BlockEnvironment& block) const { return block_points(block); }
  template <class Analytic>
  ShellPoints operator()(const Analytic& shape) const {
    return {surface_points(shape), {}};
  }
};

/// Returns true if building the shell takes longer than reading it from the cache.
bool is_worth_keeping(const Environment& environment) {
  return std::holds_alternative<BlockEnvironment>(environment) || std::holds_alternative<MeshEnvironment>(environment);
}

}  // namespace

std::string shell_definition(const Scenario& scenario, const NamedFiles& files) {
  const std::string code = loaded_code_id();
  if (code.empty()) return "";
  return json_text({{"environment", environment_content(scenario, files)}, {"code", code}});
}

EnvironmentPoints environment_points(const Scenario& scenario, const ShellCache& cache, const NamedFiles& files) {
  const auto build = [&] {
    ShellPoints points = std::visit(Build{files}, scenario.environment);
    throw_if_stopped();  // it may have taken seconds
    return points;
  };
  if (!cache.is_on() || !is_worth_keeping(scenario.environment)) return {build()};
  const std::string definition = shell_definition(scenario, files);
  if (definition.empty()) return {build()};
  if (auto points = cache.find(definition)) return {std::move(*points), true};
  EnvironmentPoints built{build()};
  cache.keep(definition, built);
  return built;
}

EnvironmentPoints environment_points(const Scenario& scenario, const ShellCache& cache) {
  return environment_points(scenario, cache, NamedFiles(scenario));
}

}  // namespace hapbench
