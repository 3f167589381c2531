#include "scenarios/run/make_shell.hpp"

#include <utility>

#include "scenarios/run/stop_signal.hpp"
#include "sim/contact/grid_index.hpp"
#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {
namespace {

using Shell = std::shared_ptr<const PointShell>;

/// Builds the shell of each type of environment.
struct Build {
  const NamedFiles& files;

  Shell operator()(const SpringsEnvironment&) const { return nullptr; }
  Shell operator()(const PointShellEnvironment& given) const {
    return of(files.at(kEnvironmentFile).points(), given.grid.value_or(0.0));
  }
  Shell operator()(const MeshEnvironment& mesh) const {
    const double cell_size = mesh.grid.value_or(0.0);
    return of(in_grid_order(files.at(kEnvironmentFile).mesh().points(), cell_size), cell_size);
  }
  Shell operator()(const BlockEnvironment& block) const {
    const DensityField field = density_field(block.block, block.grid, block.density);
    if (block.vertices == BlockVertices::shared) return std::make_shared<const PointShell>(surface_shell(field));
    ShellPoints points = points_by_cell(marching_cubes(field, {.cells = true}), block.grid);
    return of(points.points, block.grid, std::move(points.cells));
  }
  template <class Analytic>
  Shell operator()(const Analytic& shape) const {
    return of(surface_points(shape), shape.spacing);
  }

 private:
  /// cell_size: edge of the grid cells the local average merges in.
  static Shell of(const std::vector<SurfacePoint>& points, double cell_size, std::vector<std::uint32_t> cells = {}) {
    return std::make_shared<const PointShell>(points, cell_size, std::move(cells));
  }
};

}  // namespace

Shell make_shell(const Scenario& scenario, const NamedFiles& files) {
  Shell shell = std::visit(Build{files}, scenario.environment);
  throw_if_stopped();  // it may have taken seconds
  return shell;
}

Shell make_shell(const Scenario& scenario) {
  return make_shell(scenario, NamedFiles(scenario));
}

}  // namespace hapbench
