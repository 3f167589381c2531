#include "sim/mesh/marching_cubes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

#include "sim/core/parallel.hpp"
#include "sim/geometry/grid_index.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kEdgeNumbers = 24;  ///< number of values of 3 c + axis, of which 12 are edges of a cell

/// Returns the number of the cell edge between two neighbouring corners (numbering of CubeTriangle).
int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  return 3 * std::min(a, b) + axis;
}

/// Returns the corners of a face, counter-clockwise seen from outside. `side`: 0 for the face with the smaller
/// coordinate along `axis`, 1 for the opposite face.
std::array<int, 4> face_corners(int axis, int side) {
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  return side == 1 ? std::array{base, base | u, base | u | v, base | v}
                   : std::array{base, base | v, base | u | v, base | u};
}

/// Returns true if both edges lie on a common face of the cell. A diagonal between them would lie in that face and
/// might cross a diagonal of the neighbouring cell.
bool share_a_face(int first, int second) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = [axis](int edge) { return edge % 3 == axis ? -1 : (edge / 3 >> axis) & 1; };
    if (side(first) >= 0 && side(first) == side(second)) return true;
  }
  return false;
}

/// Divides the polygon into triangles by cutting off corners (ears), with diagonals through the inside of the cell
/// only. Returns false if that is impossible.
bool triangulate(const std::vector<int>& polygon, std::vector<CubeTriangle>& triangles) {
  const std::size_t n = polygon.size();
  if (n == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return true;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const int before = polygon[(i + n - 1) % n], after = polygon[(i + 1) % n];
    if (share_a_face(before, after)) continue;
    std::vector<int> rest = polygon;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
    // Cut off corner i; undo this if the rest cannot be divided.
    const std::size_t kept = triangles.size();
    triangles.push_back({before, polygon[i], after});
    if (triangulate(rest, triangles)) return true;
    triangles.resize(kept);
  }
  return false;
}

/// Grid nodes in and around the box of a density field, numbered from 0 along each axis. Cells lie between the nodes.
/// Lengths in m.
class NodeGrid {
 public:
  explicit NodeGrid(const DensityField& field) : spacing_(field.spacing) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      // Add a cell on each side, so that the surface cuts no cell at the border.
      first_[axis] = static_cast<std::int64_t>(std::floor(field.min[a] / spacing_)) - 1;
      const auto last = static_cast<std::int64_t>(std::ceil(field.max[a] / spacing_)) + 2;
      count_[axis] = static_cast<std::size_t>(last - first_[axis] + 1);
    }
  }

  std::size_t count(std::size_t axis) const { return count_[axis]; }
  double spacing() const { return spacing_; }
  Vec3 node(std::size_t i, std::size_t j, std::size_t k) const {
    const auto along = [this](std::size_t number, std::size_t axis) {
      return spacing_ * (static_cast<double>(first_[axis] + static_cast<std::int64_t>(number)) - 0.5);
    };
    return {along(i, 0), along(j, 1), along(k, 2)};
  }

 private:
  double spacing_;
  std::array<std::int64_t, 3> first_;  ///< index of the first node; index 0 is the node at -spacing / 2
  std::array<std::size_t, 3> count_;
};

/// Returns the density at a node minus the iso value; positive inside.
double density_at(const DensityField& field, const Vec3& node) {
  const double distance = field.signed_distance(node);
  return field.density == Density::signed_distance ? -distance : (distance < 0.0 ? 0.5 : -0.5);
}

/// Layer of grid nodes with equal z: the nodes inside the solid, the crossed edges that start at the nodes, and the
/// numbers of the vertices on these edges. An edge is crossed if one of its nodes is inside the solid and the other is
/// outside. Each node is one bit: word w of line j holds the nodes (64 w … 64 w + 63, j).
class GridLayer {
 public:
  /// Crossed edges that start at the nodes of a word, one bit for each node. The vertices on the edges along x and
  /// y are numbered together, node by node, x before y. The vertices on the edges along z are numbered separately.
  struct Edges {
    std::uint64_t x, y, z;
    std::uint32_t first_in_layer, first_along_z;
  };

  /// Precondition: field and grid outlive the layer.
  GridLayer(const DensityField& field, const NodeGrid& grid)
      : field_(&field),
        grid_(&grid),
        words_((grid.count(0) + 63) / 64),
        starting_in_last_((std::uint64_t{1} << (grid.count(0) - 1) % 64) - 1),
        inside_(words_ * grid.count(1)),
        edges_(words_ * grid.count(1)) {}

  /// Moves to layer k and finds the nodes inside. Cost: a few evaluations of the field for each node near the
  /// surface, and a few operations for every 64 nodes.
  void evaluate(std::size_t k) {
    k_ = k;
    std::fill(inside_.begin(), inside_.end(), 0);
    for (std::size_t j = 0; j < grid_->count(1); j += 64) {
      for (std::size_t i = 0; i < grid_->count(0); i += 64) find_inside(i, j, 64);
    }
  }

  Vec3 node(std::size_t i, std::size_t j) const { return grid_->node(i, j, k_); }

  std::size_t words() const { return words_; }
  std::uint64_t inside(std::size_t w, std::size_t j) const { return inside_[j * words_ + w]; }
  /// Returns a word whose bit b is set if the node that follows node b of word w along line j is inside.
  std::uint64_t next_inside(std::size_t w, std::size_t j) const {
    return inside(w, j) >> 1u | (w + 1 < words_ ? inside(w + 1, j) << 63u : 0);
  }
  /// Returns the nodes of word w at which an edge along x starts: all nodes except the last of the line.
  std::uint64_t starting(std::size_t w) const { return w + 1 < words_ ? ~std::uint64_t{0} : starting_in_last_; }

  Edges& edges(std::size_t w, std::size_t j) { return edges_[j * words_ + w]; }
  /// Returns the number (index) of the vertex on the crossed edge that starts at node (i, j) and runs along the axis.
  std::uint32_t vertex(std::size_t i, std::size_t j, std::size_t axis) const {
    const Edges& edges = edges_[j * words_ + i / 64];
    const std::uint64_t below = (std::uint64_t{1} << i % 64) - 1;
    const auto count = [](std::uint64_t bits) { return static_cast<std::uint32_t>(std::popcount(bits)); };
    if (axis == 2) return edges.first_along_z + count(edges.z & below);
    const bool along_x = axis == 1 && (edges.x >> i % 64 & 1u) != 0;
    return edges.first_in_layer + count(edges.x & below) + count(edges.y & below) + along_x;
  }

 private:
  /// Finds the nodes inside the solid among `size` x `size` nodes from (i, j), recursively. The square lies in one
  /// word of each line.
  void find_inside(std::size_t i, std::size_t j, std::size_t size) {
    const double half = 0.5 * grid_->spacing() * static_cast<double>(size - 1);
    const double distance = field_->signed_distance(node(i, j) + Vec3(half, half, 0.0));
    // The whole square is inside or outside if the distance at its middle is larger than the distance from the middle
    // to a corner. The factor 1 + 1e-9 covers rounding.
    if (size > 1 && std::abs(distance) <= std::numbers::sqrt2 * half * (1.0 + 1e-9)) {
      for (const std::size_t y : {j, j + size / 2}) {
        for (const std::size_t x : {i, i + size / 2}) {
          if (x < grid_->count(0) && y < grid_->count(1)) find_inside(x, y, size / 2);
        }
      }
      return;
    }
    if (!(distance < 0.0)) return;
    const std::uint64_t bits = (size < 64 ? (std::uint64_t{1} << size) - 1 : ~std::uint64_t{0}) << i % 64;
    for (std::size_t y = j; y < std::min(j + size, grid_->count(1)); ++y) inside_[y * words_ + i / 64] |= bits;
  }

  const DensityField* field_;
  const NodeGrid* grid_;
  std::size_t words_, k_ = 0;
  std::uint64_t starting_in_last_;
  std::vector<std::uint64_t> inside_;
  std::vector<Edges> edges_;
};

/// Maximum number of slabs (see Slab), independent of the number of threads. The last digits of a normal that is summed
/// in two slabs depend on the position of the slab boundary.
constexpr std::size_t kMaxSlabs = 16;

/// Calls visit(i) for each node i whose bit is set in `bits`, the word of the nodes 64 w … 64 w + 63.
template <class Visit>
void for_each_node(std::uint64_t bits, std::size_t w, Visit visit) {
  for (; bits != 0; bits &= bits - 1) visit(64 * w + static_cast<std::size_t>(std::countr_zero(bits)));
}

/// One of the 256 cases of marching cubes.
struct CutCase {
  std::vector<std::size_t> edges;  ///< crossed edges, ascending, numbered as in CubeTriangle
  std::vector<CubeTriangle> triangles;

  explicit CutCase(unsigned inside) : triangles(cube_triangles(inside)) {
    for (std::size_t edge = 0; edge < kEdgeNumbers; ++edge) {
      const std::size_t start = edge / 3, end = start | std::size_t{1} << edge % 3;
      if (start != end && (inside >> start & 1u) != (inside >> end & 1u)) edges.push_back(edge);
    }
  }
};

/// Returns all cases. Bit c of a case's index is 1 if the cell's corner c is inside the solid.
const std::vector<CutCase>& cut_cases() {
  static const auto cases = [] {
    std::vector<CutCase> all;
    for (unsigned inside = 0; inside < 256; ++inside) all.emplace_back(inside);
    return all;
  }();
  return cases;
}

/// Part of the surface in consecutive layers of cells. Its vertex numbers start at 0 and its normals are not yet
/// normalised. The vertices in its last layer of nodes are also the first vertices of the next slab.
struct Slab {
  IsoSurface surface;
  std::size_t first_in_last = 0;  ///< number of the first vertex in the last layer of nodes
};

class SlabBuilder {
 public:
  /// Precondition: field and grid outlive the builder.
  SlabBuilder(const DensityField& field, const NodeGrid& grid, IsoSurfaceOptions options)
      : field_(field), grid_(grid), options_(options), low_(field, grid), high_(field, grid) {}

  /// Returns the surface in the cells between the layers of nodes `first` and `last`. Precondition: first < last.
  Slab build(std::size_t first, std::size_t last) {
    low_.evaluate(first);
    add_vertices_in(low_);
    for (std::size_t k = first; k < last; ++k) {
      high_.evaluate(k + 1);
      add_vertices_between();
      slab_.first_in_last = next_vertex();
      add_vertices_in(high_);
      add_cells();
      std::swap(low_, high_);
    }
    return std::move(slab_);
  }

 private:
  /// Adds the vertex on the edge from p to q, by linear interpolation of the density.
  void add_vertex(const Vec3& p, const Vec3& q) {
    const double a = density_at(field_, p), b = density_at(field_, q);
    slab_.surface.vertices.push_back({p + (q - p) * (a / (a - b)), Vec3::Zero()});
  }

  std::uint32_t next_vertex() const { return static_cast<std::uint32_t>(slab_.surface.vertices.size()); }

  /// Adds the vertices on the crossed edges along x and y of a layer.
  void add_vertices_in(GridLayer& layer) {
    for (std::size_t j = 0; j < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < layer.words(); ++w) {
        GridLayer::Edges& edges = layer.edges(w, j);
        edges.x = (layer.inside(w, j) ^ layer.next_inside(w, j)) & layer.starting(w);
        edges.y = j + 1 < grid_.count(1) ? layer.inside(w, j) ^ layer.inside(w, j + 1) : 0;
        edges.first_in_layer = next_vertex();
        for_each_node(edges.x | edges.y, w, [&](std::size_t i) {
          if ((edges.x >> i % 64 & 1u) != 0) add_vertex(layer.node(i, j), layer.node(i + 1, j));
          if ((edges.y >> i % 64 & 1u) != 0) add_vertex(layer.node(i, j), layer.node(i, j + 1));
        });
      }
    }
  }

  /// Adds the vertices on the crossed edges along z between the two layers.
  void add_vertices_between() {
    for (std::size_t j = 0; j < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < low_.words(); ++w) {
        GridLayer::Edges& edges = low_.edges(w, j);
        edges.z = low_.inside(w, j) ^ high_.inside(w, j);
        edges.first_along_z = next_vertex();
        for_each_node(edges.z, w, [&](std::size_t i) { add_vertex(low_.node(i, j), high_.node(i, j)); });
      }
    }
  }

  /// Adds the cells that the surface cuts, between the two layers of nodes.
  void add_cells() {
    const std::vector<CutCase>& cases = cut_cases();
    for (std::size_t j = 0; j + 1 < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < low_.words(); ++w) {
        // corners[c] has one bit for each of 64 cells: 1 if the cell's corner c (numbering of CubeTriangle) is inside
        // the solid.
        const std::array<std::uint64_t, 8> corners{
            low_.inside(w, j),  low_.next_inside(w, j),  low_.inside(w, j + 1),  low_.next_inside(w, j + 1),
            high_.inside(w, j), high_.next_inside(w, j), high_.inside(w, j + 1), high_.next_inside(w, j + 1)};
        std::uint64_t any = 0, all = ~std::uint64_t{0};
        for (const std::uint64_t corner : corners) {
          any |= corner;
          all &= corner;
        }
        for_each_node(any & ~all & low_.starting(w), w, [&](std::size_t i) {
          unsigned inside = 0;
          for (std::size_t c = 0; c < 8; ++c) inside |= static_cast<unsigned>(corners[c] >> i % 64 & 1u) << c;
          add_cell(i, j, cases[inside]);
        });
      }
    }
  }

  /// Adds the triangles of one cell, and their normals to their vertices.
  void add_cell(std::size_t i, std::size_t j, const CutCase& cut) {
    auto& [vertices, triangles, cells] = slab_.surface;
    // Determine the numbers of the vertices on the crossed edges.
    std::array<std::uint32_t, kEdgeNumbers> numbers{};
    for (const std::size_t edge : cut.edges) {
      const std::size_t corner = edge / 3;
      numbers[edge] = (corner < 4 ? low_ : high_).vertex(i + (corner & 1), j + (corner >> 1 & 1), edge % 3);
      if (options_.cells) cells.vertices.push_back(numbers[edge]);
    }
    // Add the triangles, and add their normals to the normals of their vertices.
    for (const CubeTriangle& edges : cut.triangles) {
      const auto number = [&](std::size_t k) { return numbers[static_cast<std::size_t>(edges[k])]; };
      const std::array triangle{number(0), number(1), number(2)};
      const auto& [a, b, c] = triangle;
      const Vec3 normal = triangle_normal(vertices[a].position, vertices[b].position, vertices[c].position);
      for (const std::uint32_t vertex : triangle) vertices[vertex].normal += normal;
      if (options_.triangles) triangles.push_back(triangle);
    }
    if (options_.cells) {
      cells.centres.push_back(low_.node(i, j) + Vec3::Constant(0.5 * grid_.spacing()));
      cells.starts.push_back(static_cast<std::uint32_t>(cells.vertices.size()));
    }
  }

  const DensityField& field_;
  const NodeGrid& grid_;
  IsoSurfaceOptions options_;
  GridLayer low_, high_;  ///< layers below and above the current cells
  Slab slab_;
};

/// Merges the vertices that two neighbouring slabs share: removes them from the lower slab, and adds their normals to
/// the normals in the upper slab.
void move_shared_vertices(std::vector<Slab>& slabs) {
  for (std::size_t s = 0; s + 1 < slabs.size(); ++s) {
    std::vector<SurfacePoint>&below = slabs[s].surface.vertices, &above = slabs[s + 1].surface.vertices;
    const std::size_t first = slabs[s].first_in_last;
    for (std::size_t i = first; i < below.size(); ++i) above[i - first].normal += below[i].normal;
    below.resize(first);
  }
}

/// Appends a slab to the surface, with its vertex numbers shifted and its normals normalised.
void append(const IsoSurface& slab, IsoSurface& all) {
  const auto offset = static_cast<std::uint32_t>(all.vertices.size());
  for (const auto& [position, normal] : slab.vertices) all.vertices.push_back({position, unit_or(normal, normal)});
  for (const auto& [a, b, c] : slab.triangles) all.triangles.push_back({a + offset, b + offset, c + offset});
  const auto listed = static_cast<std::uint32_t>(all.cells.vertices.size());
  all.cells.centres.insert(all.cells.centres.end(), slab.cells.centres.begin(), slab.cells.centres.end());
  for (const std::uint32_t vertex : slab.cells.vertices) all.cells.vertices.push_back(vertex + offset);
  for (std::size_t i = 1; i < slab.cells.starts.size(); ++i) all.cells.starts.push_back(listed + slab.cells.starts[i]);
}

}  // namespace

// Each face of the cell contributes directed segments that cut off its inside corners. On a walk around the face, a
// segment starts at the edge where the walk enters a sequence of inside corners, and ends at the edge where the walk
// leaves this sequence. Every crossed edge belongs to two faces. It is the end of a segment on one face and the start
// of a segment on the other, so the segments form closed polygons.
std::vector<CubeTriangle> cube_triangles(unsigned inside) {
  const auto is_inside = [inside](int corner) { return (inside >> corner & 1u) != 0; };
  std::array<int, kEdgeNumbers> next{};
  next.fill(-1);
  for (int face = 0; face < 6; ++face) {
    const std::array<int, 4> c = face_corners(face / 2, face % 2);
    for (std::size_t i = 0; i < 4; ++i) {
      if (is_inside(c[i]) || !is_inside(c[(i + 1) % 4])) continue;
      std::size_t last = i + 1;
      while (is_inside(c[(last + 1) % 4])) ++last;
      next[static_cast<std::size_t>(edge_between(c[i], c[(i + 1) % 4]))] = edge_between(c[last % 4], c[(last + 1) % 4]);
    }
  }
  // Follow the segments around each closed polygon, and divide the polygon into triangles.
  std::vector<CubeTriangle> triangles;
  for (std::size_t start = 0; start < next.size(); ++start) {
    std::vector<int> polygon;
    for (int edge = static_cast<int>(start); next[static_cast<std::size_t>(edge)] >= 0;) {
      polygon.push_back(edge);
      edge = std::exchange(next[static_cast<std::size_t>(edge)], -1);
    }
    if (polygon.empty() || triangulate(polygon, triangles)) continue;
    // Only a polygon that crosses one face twice cannot be divided by diagonals through the inside of the cell. Divide
    // this polygon into a fan of triangles.
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
  }
  return triangles;
}

DensityField density_field(const BlockWithHole& block, double spacing, Density density) {
  return {.signed_distance = [block](const Vec3& point) { return signed_distance(block, point); },
          .min = {-block.size.x() / 2, -block.size.y() / 2, -block.size.z()},
          .max = {block.size.x() / 2, block.size.y() / 2, 0.0},
          .spacing = spacing,
          .density = density};
}

IsoSurface marching_cubes(const DensityField& field, IsoSurfaceOptions options) {
  const NodeGrid grid(field);
  const std::size_t layers = grid.count(2) - 1, thickness = (layers + kMaxSlabs - 1) / kMaxSlabs;
  std::vector<Slab> slabs((layers + thickness - 1) / thickness);
  // Compute the slabs in parallel.
  parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
    slabs[s] = SlabBuilder(field, grid, options).build(s * thickness, std::min((s + 1) * thickness, layers));
  });
  move_shared_vertices(slabs);
  // Join the slabs to one surface.
  std::size_t vertices = 0;
  for (const Slab& slab : slabs) vertices += slab.surface.vertices.size();
  IsoSurface surface;
  surface.vertices.reserve(vertices);
  for (Slab& slab : slabs) {
    append(slab.surface, surface);
    slab = {};  // release the slab at once, so that not all vertices are stored twice
  }
  return surface;
}

PointShell surface_shell(const DensityField& field) {
  std::vector<SurfacePoint> vertices = marching_cubes(field).vertices;
  std::erase_if(vertices, [](const SurfacePoint& vertex) { return vertex.normal.isZero(0.0); });
  vertices = in_grid_order(vertices, field.spacing);
  return {vertices, field.spacing};
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
  // Append the vertices of each cell, cell by cell. A vertex of several cells is appended once for each of them.
  for (const std::uint32_t cell : grid_order(centres, spacing)) {
    for (std::uint32_t i = cells.starts[cell]; i < cells.starts[cell + 1]; ++i) {
      const SurfacePoint& vertex = surface.vertices[cells.vertices[i]];
      if (vertex.normal.isZero(0.0)) continue;
      shell.points.push_back(vertex);
      shell.cells.push_back(number);
    }
    // A cell without points receives no number.
    if (!shell.cells.empty() && shell.cells.back() == number) ++number;
  }
  return shell;
}

}  // namespace hapbench
