#include "sim/mesh/points_by_cell.hpp"

#include "sim/contact/grid_index.hpp"

namespace hapbench {

ShellPoints points_by_cell(const IsoSurface& surface, double spacing) {
  const CutCells& cells = surface.cells;
  std::vector<SurfacePoint> centres;
  centres.reserve(cells.centres.size());
  for (const Vec3& centre : cells.centres) centres.push_back({centre});

  ShellPoints shell;
  shell.points.reserve(cells.vertices.size());
  shell.cells.reserve(cells.vertices.size());
  std::uint32_t number = 0;
  for (const std::uint32_t cell : grid_order(centres, spacing)) {
    for (std::uint32_t i = cells.starts[cell]; i < cells.starts[cell + 1]; ++i) {
      const SurfacePoint& vertex = surface.vertices[cells.vertices[i]];
      if (vertex.normal.isZero(0.0)) continue;
      shell.points.push_back(vertex);
      shell.cells.push_back(number);
    }
    // Numbers have no gap where a cell has no point left.
    if (!shell.cells.empty() && shell.cells.back() == number) ++number;
  }
  return shell;
}

}  // namespace hapbench
