#include "sim/mesh/marching_cubes.hpp"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "sim/mesh/cube_cases.hpp"
#include "sim/mesh/grid_layer.hpp"
#include "sim/mesh/triangle_normal.hpp"

namespace hapbench {
namespace {

/// Layers are shared out in so many slabs at most, whatever the number of threads, because a normal that is summed in
/// two slabs depends in its last digits on where they meet.
constexpr std::size_t kMostSlabs = 16;

/// Two neighbouring layers of nodes, which a thread uses for slab after slab.
struct LayerPair {
  GridLayer low, high;
  explicit LayerPair(const NodeGrid& grid) : low(grid), high(grid) {}
};

/// The part of the surface in some layers of cells, both layers of nodes at its ends included: the vertices in them are
/// the neighbours', too. Normals are sums yet.
class Slab {
 public:
  /// Cells between the layers of nodes first < last.
  void build(const DensityField& field, const NodeGrid& grid, KeptOfSurface kept, LayerPair& layers, std::size_t first,
             std::size_t last) {
    grid_ = &grid;
    kept_ = kept;
    low_ = &layers.low;
    high_ = &layers.high;
    low_->evaluate(field, grid, first);
    add_vertices_in(*low_, first);
    in_first_layer_ = surface_.vertices.size();
    for (std::size_t k = first; k < last; ++k) {
      high_->evaluate(field, grid, k + 1);
      add_vertices_between(k);
      const std::size_t before = surface_.vertices.size();
      add_vertices_in(*high_, k + 1);
      in_last_layer_ = surface_.vertices.size() - before;
      for (const std::uint32_t node : low_->near()) add_cell(node, k);
      std::swap(low_, high_);
    }
  }

  IsoSurface& surface() { return surface_; }
  std::size_t in_first_layer() const { return in_first_layer_; }
  std::size_t in_last_layer() const { return in_last_layer_; }
  /// How many of the vertices are not left to the next slab.
  std::size_t own() const { return surface_.vertices.size() - in_last_layer_; }

 private:
  Vec3 position(std::size_t node, std::size_t k) const {
    return grid_->node(node % grid_->count(0), node / grid_->count(0), k);
  }

  /// Adds the vertex between two nodes of densities a and b if the surface runs between them.
  void add_vertex(std::size_t node, std::size_t axis, std::size_t k, GridLayer& layer, double a, double b) {
    if (std::isnan(b) || (a > 0.0) == (b > 0.0)) return;
    layer.on_edge(node, axis) = static_cast<std::uint32_t>(surface_.vertices.size());
    const std::array<std::size_t, 3> next{1, grid_->count(0), 0};
    const Vec3 p = position(node, k), q = position(node + next[axis], k + (axis == 2));
    surface_.vertices.push_back({p + (q - p) * (a / (a - b)), Vec3::Zero()});
  }

  void add_vertices_in(GridLayer& layer, std::size_t k) {
    const std::size_t row = grid_->count(0), nodes = grid_->nodes_in_layer();
    for (const std::uint32_t node : layer.near()) {
      const double a = layer.density(node);
      if (node % row + 1 < row) add_vertex(node, 0, k, layer, a, layer.density(node + 1));
      if (node + row < nodes) add_vertex(node, 1, k, layer, a, layer.density(node + row));
    }
  }

  void add_vertices_between(std::size_t k) {
    for (const std::uint32_t node : low_->near())
      add_vertex(node, 2, k, *low_, low_->density(node), high_->density(node));
  }

  /// The triangles in the cell whose lowest corner is the node.
  void add_cell(std::size_t node, std::size_t k) {
    const std::size_t row = grid_->count(0);
    if (node % row + 1 >= row || node + row >= grid_->nodes_in_layer()) return;
    const std::array<std::size_t, 4> corners{node, node + 1, node + row, node + row + 1};
    unsigned inside = 0;
    for (unsigned c = 0; c < 8; ++c) {
      const double density = (c < 4 ? low_ : high_)->density(corners[c & 3u]);
      if (std::isnan(density)) return;
      if (density > 0.0) inside |= 1u << c;
    }
    if (inside == 0 || inside == 0xff) return;
    std::array<std::uint32_t, 24> on_edge;  // numbered as in cube_cases.hpp
    std::uint32_t crossed = 0;
    for (const CubeTriangle& edges : cube_triangles(inside)) {
      std::array<std::uint32_t, 3> triangle;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto edge = static_cast<std::size_t>(edges[i]), corner = edge / 3;
        triangle[i] = on_edge[edge] = (corner < 4 ? low_ : high_)->on_edge(corners[corner & 3u], edge % 3);
        crossed |= 1u << edge;
      }
      add_triangle(triangle);
    }
    if (kept_.cells) add_cut_cell(position(node, k), on_edge, crossed);
  }

  void add_triangle(const std::array<std::uint32_t, 3>& triangle) {
    std::vector<SurfacePoint>& v = surface_.vertices;
    const Vec3 normal = triangle_normal(v[triangle[0]].position, v[triangle[1]].position, v[triangle[2]].position);
    for (const std::uint32_t corner : triangle) v[corner].normal += normal;
    if (kept_.triangles) surface_.triangles.push_back(triangle);
  }

  void add_cut_cell(const Vec3& lowest, const std::array<std::uint32_t, 24>& on_edge, std::uint32_t crossed) {
    CutCells& cells = surface_.cells;
    cells.centres.push_back(lowest + Vec3::Constant(0.5 * grid_->spacing()));
    for (std::size_t edge = 0; edge < on_edge.size(); ++edge) {
      if ((crossed >> edge & 1u) != 0) cells.vertices.push_back(on_edge[edge]);
    }
    cells.starts.push_back(static_cast<std::uint32_t>(cells.vertices.size()));
  }

  const NodeGrid* grid_ = nullptr;
  KeptOfSurface kept_;
  GridLayer* low_ = nullptr;
  GridLayer* high_ = nullptr;
  IsoSurface surface_;
  std::size_t in_first_layer_ = 0, in_last_layer_ = 0;
};

/// Completes the sums of normals where slabs meet, and gives all of them length one.
void normalise(std::vector<Slab>& slabs) {
  tbb::parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
    std::vector<SurfacePoint>& own = slabs[s].surface().vertices;
    for (std::size_t i = 0; s > 0 && i < slabs[s].in_first_layer(); ++i)
      own[i].normal += slabs[s - 1].surface().vertices[slabs[s - 1].own() + i].normal;
    const std::size_t count = s + 1 < slabs.size() ? slabs[s].own() : own.size();
    for (std::size_t i = 0; i < count; ++i) {
      const double length = own[i].normal.norm();
      if (length > 0.0) own[i].normal /= length;
    }
  });
}

/// Appends the slab without the last `left` vertices, which the next one has, too.
void append(const IsoSurface& slab, std::size_t left, IsoSurface& all) {
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  all.vertices.insert(all.vertices.end(), slab.vertices.begin(),
                      slab.vertices.end() - static_cast<std::ptrdiff_t>(left));
  for (const auto& [a, b, c] : slab.triangles) all.triangles.push_back({a + offset, b + offset, c + offset});
  const auto listed = static_cast<std::uint32_t>(all.cells.vertices.size());
  all.cells.centres.insert(all.cells.centres.end(), slab.cells.centres.begin(), slab.cells.centres.end());
  for (const std::uint32_t vertex : slab.cells.vertices) all.cells.vertices.push_back(vertex + offset);
  for (std::size_t i = 1; i < slab.cells.starts.size(); ++i) all.cells.starts.push_back(listed + slab.cells.starts[i]);
}

}  // namespace

IsoSurface marching_cubes(const DensityField& field, KeptOfSurface kept) {
  const NodeGrid grid(field);
  const std::size_t layers = grid.count(2) - 1, thickness = (layers + kMostSlabs - 1) / kMostSlabs;
  std::vector<Slab> slabs((layers + thickness - 1) / thickness);
  tbb::enumerable_thread_specific<LayerPair> workspaces(grid);
  tbb::parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
    slabs[s].build(field, grid, kept, workspaces.local(), s * thickness, std::min((s + 1) * thickness, layers));
  });
  workspaces.clear();

  normalise(slabs);
  std::size_t vertices = slabs.back().in_last_layer();
  for (const Slab& slab : slabs) vertices += slab.own();
  IsoSurface surface;
  surface.vertices.reserve(vertices);
  for (Slab& slab : slabs) {
    append(slab.surface(), &slab == &slabs.back() ? 0 : slab.in_last_layer(), surface);
    slab = {};  // or memory would hold all vertices twice
  }
  return surface;
}

}  // namespace hapbench
