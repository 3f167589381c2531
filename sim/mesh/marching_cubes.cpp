#include "sim/mesh/marching_cubes.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>

#include "sim/mesh/cube_cases.hpp"

namespace hapbench {
namespace {

using Index = std::array<std::int64_t, 3>;
/// The vertex on each edge of a cell, numbered as in cube_cases.hpp; invalid where the surface does not cross it.
using EdgeVertices = std::array<OpenMesh::VertexHandle, 24>;

/// Cell (i, j, k) spans the nodes (i - 1/2, j - 1/2, k - 1/2) … (i + 1/2, …) in units of the spacing; node (i, j, k) is
/// its lowest corner.
class Builder {
 public:
  Builder(const DensityField& field, CutCells* cells) : field_(field), cells_(cells) {}

  HalfEdgeMesh build() {
    Index first, last;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      first[axis] = static_cast<std::int64_t>(std::floor(field_.min[a] / field_.spacing)) - 1;
      last[axis] = static_cast<std::int64_t>(std::ceil(field_.max[a] / field_.spacing)) + 1;
    }
    visit(first, last);
    return std::move(mesh_);
  }

 private:
  Vec3 node(const Index& n) const {
    return field_.spacing *
           Vec3(static_cast<double>(n[0]) - 0.5, static_cast<double>(n[1]) - 0.5, static_cast<double>(n[2]) - 0.5);
  }

  /// Cells first … last, both included: halved along the longest side until one is left or the surface is too far away.
  void visit(const Index& first, const Index& last) {
    const Vec3 low = node(first), high = node({last[0] + 1, last[1] + 1, last[2] + 1});
    // 1e-9 of slack for the rounding of the distance.
    if (std::abs(field_.signed_distance(0.5 * (low + high))) > 0.5 * (high - low).norm() * (1.0 + 1e-9)) return;
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a) {
      if (last[a] - first[a] > last[axis] - first[axis]) axis = a;
    }
    if (last[axis] == first[axis]) return add_cell(first);
    Index middle = last, after = first;
    middle[axis] = first[axis] + (last[axis] - first[axis]) / 2;
    after[axis] = middle[axis] + 1;
    visit(first, middle);
    visit(after, last);
  }

  /// Positive inside.
  double density(const Index& n) const {
    const double d = field_.signed_distance(node(n));
    return field_.density == Density::signed_distance ? -d : (d < 0.0 ? 0.5 : -0.5);
  }

  void add_cell(const Index& cell) {
    std::array<double, 8> values;
    unsigned inside = 0;
    for (std::size_t c = 0; c < 8; ++c) {
      values[c] = density(corner(cell, static_cast<int>(c)));
      if (values[c] > 0.0) inside |= 1u << c;
    }
    EdgeVertices on_edge;
    for (const CubeTriangle& triangle : cube_triangles(inside)) {
      std::array<OpenMesh::VertexHandle, 3> v;
      for (std::size_t i = 0; i < 3; ++i) {
        v[i] = on_edge[static_cast<std::size_t>(triangle[i])];
        if (!v[i].is_valid()) {
          v[i] = on_edge[static_cast<std::size_t>(triangle[i])] = vertex(cell, triangle[i], values);
        }
      }
      if (!mesh_.add_face(v[0], v[1], v[2]).is_valid())
        throw std::runtime_error("marching cubes: the surface is not manifold");
    }
    if (cells_ != nullptr && inside != 0 && inside != 0xff) list(cell, on_edge);
  }

  void list(const Index& cell, const EdgeVertices& on_edge) {
    cells_->centres.push_back(node(cell) + Vec3::Constant(0.5 * field_.spacing));
    for (const OpenMesh::VertexHandle vertex : on_edge) {
      if (vertex.is_valid()) cells_->vertices.push_back(static_cast<std::uint32_t>(vertex.idx()));
    }
    cells_->starts.push_back(static_cast<std::uint32_t>(cells_->vertices.size()));
  }

  static Index corner(const Index& cell, int c) {
    return {cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2 & 1)};
  }

  /// The vertex on an edge of the cell, made once for the up to four cells around the edge.
  OpenMesh::VertexHandle vertex(const Index& cell, int edge, const std::array<double, 8>& values) {
    const int from = edge / 3, to = from | 1 << edge % 3;
    const Index start = corner(cell, from);
    const auto [entry, is_new] = vertices_.try_emplace(key(start, edge % 3));
    if (is_new) {
      const double a = values[static_cast<std::size_t>(from)], b = values[static_cast<std::size_t>(to)];
      const Vec3 p = node(start), q = node(corner(cell, to));
      const Vec3 crossing = p + (q - p) * (a / (a - b));
      entry->second = mesh_.add_vertex({crossing.x(), crossing.y(), crossing.z()});
    }
    return entry->second;
  }

  /// 20 bits per coordinate: cell_count bounds the grid far below.
  static std::uint64_t key(const Index& n, int axis) {
    constexpr std::int64_t kOffset = 1 << 19;
    std::uint64_t key = static_cast<std::uint64_t>(axis);
    for (const std::int64_t i : n) key = key << 20 | static_cast<std::uint64_t>(i + kOffset);
    return key;
  }

  const DensityField& field_;
  CutCells* cells_;
  HalfEdgeMesh mesh_;
  std::unordered_map<std::uint64_t, OpenMesh::VertexHandle> vertices_;
};

}  // namespace

double cell_count(const DensityField& field) {
  const Vec3 cells = (field.max - field.min) / field.spacing + Vec3::Constant(3.0);
  return cells.x() * cells.y() * cells.z();
}

HalfEdgeMesh marching_cubes(const DensityField& field, CutCells* cells) {
  return Builder(field, cells).build();
}

}  // namespace hapbench
