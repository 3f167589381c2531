#include "sim/mesh/surface_shell.hpp"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>

#include "sim/contact/grid_index.hpp"
#include "sim/mesh/surface_slab.hpp"

namespace hapbench {
namespace {

using Numbers = std::vector<std::uint32_t>;

/// A box that grows from no point.
const Box kNothing{Vec3::Constant(std::numeric_limits<double>::infinity()),
                   Vec3::Constant(-std::numeric_limits<double>::infinity())};

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

/// The vertices of a surface with their normals, on their way into a shell. All work is shared out by layers.
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
    Box all = kNothing;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      size_ += layers_[l].vertices.size();
      all = {all.min.cwiseMin(boxes[l].min), all.max.cwiseMax(boxes[l].max)};
    }
    if (size_ > 0) bounds_ = all;
  }

  PointShell build() {
    const std::vector<Numbers> places = places_in(GridCells(bounds_, size_, grid_.spacing()));
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
    tbb::parallel_for(std::size_t{0}, layers_.size(), work);
  }

  Box box_of(const SurfaceLayer& layer) const {
    Box box = kNothing;
    for (const EdgeVertex& vertex : layer.vertices) {
      const Vec3 point = position(grid_, vertex);
      box.min = box.min.cwiseMin(point);
      box.max = box.max.cwiseMax(point);
    }
    return box;
  }

  /// The place of each layer's vertices in the order of cells; vertices of one cell keep theirs. A counting sort in two
  /// steps: into the slices that cells of equal x make, and then slice by slice, whose counts fit into a cache.
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

    // By slice: the cells of the vertices, then their places.
    const auto by_slice = std::make_unique_for_overwrite<std::uint32_t[]>(size_);
    const auto for_each_vertex = [&](auto visit) {
      for_each_layer([&](std::size_t l) {
        Numbers next = first[l];
        for (std::uint32_t& number : cells[l]) visit(number, by_slice[next[number / cells_in_slice]++]);
      });
    };
    for_each_vertex([&](std::uint32_t cell, std::uint32_t& sorted) { sorted = cell; });
    tbb::enumerable_thread_specific<Numbers> counts;
    tbb::parallel_for(std::size_t{0}, slices, [&](std::size_t slice) {
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

PointShell surface_shell(const DensityField& field) {
  return ShellBuilder(field).build();
}

}  // namespace hapbench
