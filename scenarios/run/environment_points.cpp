#include "scenarios/run/environment_points.hpp"

#include "scenarios/run/stop_signal.hpp"
#include "sim/contact/grid_index.hpp"
#include "sim/mesh/block_field.hpp"
#include "sim/mesh/points_by_cell.hpp"

namespace hapbench {
namespace {

/// The vertices of the surface of the density field, in the order that the contact search likes best.
ShellPoints block_points(const BlockEnvironment& environment) {
  const DensityField field = density_field(environment.block, environment.grid, environment.density);
  if (environment.vertices == BlockVertices::per_cell)
    return points_by_cell(marching_cubes(field, {.cells = true}), environment.grid);
  std::vector<SurfacePoint> vertices = marching_cubes(field).vertices;
  std::erase_if(vertices, [](const SurfacePoint& vertex) { return vertex.normal.isZero(0.0); });
  return {in_grid_order(vertices, environment.grid), {}};
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

}  // namespace

ShellPoints environment_points(const Scenario& scenario, const NamedFiles& files) {
  ShellPoints points = std::visit(Build{files}, scenario.environment);
  throw_if_stopped();  // it may have taken seconds
  return points;
}

ShellPoints environment_points(const Scenario& scenario) {
  return environment_points(scenario, NamedFiles(scenario));
}

}  // namespace hapbench
