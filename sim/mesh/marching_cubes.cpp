#include "sim/mesh/marching_cubes.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <numeric>
#include <utility>

#include "sim/contact/grid_index.hpp"
#include "sim/core/parallel.hpp"
#include "sim/mesh/surface_slab.hpp"

namespace hapbench {

DensityField density_field(const BlockWithHole& block, double spacing, Density density) {
  return {.signed_distance = [block](const Vec3& point) { return signed_distance(block, point); },
          .min = {-block.size.x() / 2, -block.size.y() / 2, -block.size.z()},
          .max = {block.size.x() / 2, block.size.y() / 2, 0.0},
          .spacing = spacing,
          .density = density};
}

namespace {

void append(const SurfaceSlab& slab, const NodeGrid& grid, IsoSurface& all) {
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  for (const SurfaceLayer& layer : slab.layers) {
    for (std::size_t i = 0; i < layer.vertices.size(); ++i)
      all.vertices.push_back({position(grid, layer.vertices[i]), layer.normals[i]});
  }
  for (const auto& [a, b, c] : slab.triangles) all.triangles.push_back({a + offset, b + offset, c + offset});
  const auto listed = static_cast<std::uint32_t>(all.cells.vertices.size());
  all.cells.centres.insert(all.cells.centres.end(), slab.cells.centres.begin(), slab.cells.centres.end());
  for (const std::uint32_t vertex : slab.cells.vertices) all.cells.vertices.push_back(vertex + offset);
  for (std::size_t i = 1; i < slab.cells.starts.size(); ++i) all.cells.starts.push_back(listed + slab.cells.starts[i]);
}

using Numbers = std::vector<std::uint32_t>;

void drop_those_without_normal(SurfaceLayer& layer) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < layer.normals.size(); ++i) {
    if (layer.normals[i].isZero(0.0)) continue;
    layer.vertices[kept] = layer.vertices[i];
    layer.normals[kept++] = layer.normals[i];
  }
  layer.vertices.resize(kept);
  layer.normals.resize(kept);
}

/// Makes a shell of the vertices of a surface, in parallel over layers.
class ShellBuilder {
 public:
  explicit ShellBuilder(const DensityField& field) : grid_(field) {
    for (SurfaceSlab& slab : surface_slabs(field, grid_, {}))
      std::ranges::move(slab.layers, std::back_inserter(layers_));
    std::vector<Box> boxes(layers_.size());
    for_each_layer([&](std::size_t l) {
      drop_those_without_normal(layers_[l]);
      boxes[l] = box_of(layers_[l]);
    });
    Box all = Box::nothing();
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      size_ += layers_[l].vertices.size();
      all = {all.min.cwiseMin(boxes[l].min), all.max.cwiseMax(boxes[l].max)};
    }
    if (size_ > 0) bounds_ = all;
  }

  PointShell build() {
    const std::vector<Numbers> places = places_in(GridCells::for_spacing(bounds_, size_, grid_.spacing()));
    ShellColumns columns(size_);
    for_each_layer([&](std::size_t l) {
      for (std::size_t i = 0; i < places[l].size(); ++i)
        columns.set(places[l][i], position(grid_, layers_[l].vertices[i]), layers_[l].normals[i]);
      layers_[l] = SurfaceLayer();
    });
    return {std::move(columns), size_, bounds_, grid_.spacing()};
  }

 private:
  template <class Work>
  void for_each_layer(Work work) const {
    parallel_for(std::size_t{0}, layers_.size(), work);
  }

  Box box_of(const SurfaceLayer& layer) const {
    Box box = Box::nothing();
    for (const EdgeVertex& vertex : layer.vertices) box.add(position(grid_, vertex));
    return box;
  }

  /// The place of each layer's vertices in the order of cells; vertices of one cell keep their order. A counting sort
  /// in two steps, first into slices of cells with equal x and then within each slice, whose counts fit into a cache.
  std::vector<Numbers> places_in(const GridCells& grid) const {
    const std::size_t slices = grid.count(0), cells_in_slice = grid.count(1) * grid.count(2);
    std::vector<Numbers> cells(layers_.size()), first(layers_.size());
    for_each_layer([&](std::size_t l) {
      first[l].resize(slices);
      cells[l].reserve(layers_[l].vertices.size());
      for (const EdgeVertex& vertex : layers_[l].vertices) {
        cells[l].push_back(grid.cell_of(position(grid_, vertex)));
        ++first[l][cells[l].back() / cells_in_slice];
      }
    });
    Numbers slice_first;
    std::uint32_t place = 0;
    for (std::size_t slice = 0; slice < slices; ++slice) {
      slice_first.push_back(place);
      for (Numbers& of_layer : first) place += std::exchange(of_layer[slice], place);
    }
    slice_first.push_back(place);

    // By slice: first the cells of the vertices, then their places.
    const auto by_slice = std::make_unique_for_overwrite<std::uint32_t[]>(size_);
    const auto for_each_vertex = [&](auto visit) {
      for_each_layer([&](std::size_t l) {
        Numbers next = first[l];
        for (std::uint32_t& number : cells[l]) visit(number, by_slice[next[number / cells_in_slice]++]);
      });
    };
    for_each_vertex([&](std::uint32_t cell, std::uint32_t& sorted) { sorted = cell; });
    PerThread<Numbers> counts;
    parallel_for(std::size_t{0}, slices, [&](std::size_t slice) {
      Numbers& next = counts.local();
      next.assign(cells_in_slice, 0);
      std::uint32_t* const begin = &by_slice[slice_first[slice]];
      std::uint32_t* const end = &by_slice[slice_first[slice + 1]];
      const auto in_slice = [&](std::uint32_t cell) { return cell - slice * cells_in_slice; };
      for (const std::uint32_t* cell = begin; cell != end; ++cell) ++next[in_slice(*cell)];
      std::exclusive_scan(next.begin(), next.end(), next.begin(), slice_first[slice]);
      for (std::uint32_t* cell = begin; cell != end; ++cell) *cell = next[in_slice(*cell)]++;
    });
    for_each_vertex([&](std::uint32_t& number, std::uint32_t sorted) { number = sorted; });
    return cells;
  }

  NodeGrid grid_;
  std::vector<SurfaceLayer> layers_;
  std::size_t size_ = 0;
  Box bounds_;
};

}  // namespace

IsoSurface marching_cubes(const DensityField& field, KeptOfSurface kept) {
  const NodeGrid grid(field);
  std::vector<SurfaceSlab> slabs = surface_slabs(field, grid, kept);
  std::size_t vertices = 0;
  for (const SurfaceSlab& slab : slabs) {
    for (const SurfaceLayer& layer : slab.layers) vertices += layer.vertices.size();
  }
  IsoSurface surface;
  surface.vertices.reserve(vertices);
  for (SurfaceSlab& slab : slabs) {
    append(slab, grid, surface);
    slab = {};  // otherwise memory would hold all vertices twice
  }
  return surface;
}

PointShell surface_shell(const DensityField& field) {
  return ShellBuilder(field).build();
}

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
    // A cell without points gets no number.
    if (!shell.cells.empty() && shell.cells.back() == number) ++number;
  }
  return shell;
}

}  // namespace hapbench
