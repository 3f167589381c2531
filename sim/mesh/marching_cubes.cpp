#include "sim/mesh/marching_cubes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <numeric>
#include <utility>

#include "sim/contact/grid_index.hpp"
#include "sim/core/parallel.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {
namespace {

constexpr int kEdgeNumbers = 24;  ///< values of 3 c + axis, of which 12 are edges

int edge_between(int a, int b) {
  const int axis = (a ^ b) == 1 ? 0 : (a ^ b) == 2 ? 1 : 2;
  return 3 * std::min(a, b) + axis;
}

/// The corners of a face, counter-clockwise seen from outside.
std::array<int, 4> face_corners(int axis, int side) {
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, base = side << axis;
  return side == 1 ? std::array{base, base | u, base | u | v, base | v}
                   : std::array{base, base | v, base | u | v, base | u};
}

/// True if both edges lie on one face of the cell: a diagonal between them would lie in that face and might cross the
/// neighbour's.
bool share_a_face(int first, int second) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = [axis](int edge) { return edge % 3 == axis ? -1 : (edge / 3 >> axis) & 1; };
    if (side(first) >= 0 && side(first) == side(second)) return true;
  }
  return false;
}

/// Cuts ears off the polygon with diagonals through the inside of the cell; returns false if that is impossible.
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
    const std::size_t kept = triangles.size();
    triangles.push_back({before, polygon[i], after});
    if (triangulate(rest, triangles)) return true;
    triangles.resize(kept);
  }
  return false;
}

/// The nodes around the box of a density field, numbered from 0 along each axis; cells lie between them. Lengths in m.
class NodeGrid {
 public:
  explicit NodeGrid(const DensityField& field) : spacing_(field.spacing) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      // One more cell on each side, so that the surface cuts no cell at the border.
      first_[axis] = static_cast<std::int64_t>(std::floor(field.min[a] / spacing_)) - 1;
      const auto last = static_cast<std::int64_t>(std::ceil(field.max[a] / spacing_)) + 2;
      count_[axis] = static_cast<std::size_t>(last - first_[axis] + 1);
    }
  }

  std::size_t count(std::size_t axis) const { return count_[axis]; }
  double spacing() const { return spacing_; }
  double coordinate(std::size_t i, std::size_t axis) const {
    return spacing_ * (static_cast<double>(first_[axis] + static_cast<std::int64_t>(i)) - 0.5);
  }
  Vec3 node(std::size_t i, std::size_t j, std::size_t k) const {
    return {coordinate(i, 0), coordinate(j, 1), coordinate(k, 2)};
  }

 private:
  double spacing_;
  std::array<std::int64_t, 3> first_;  ///< first node, in spacings from the node at -1/2
  std::array<std::size_t, 3> count_;
};

/// A vertex on an edge of the grid, in 16 bytes instead of a position's 24, because there are millions of them.
struct EdgeVertex {
  double along;        ///< coordinate along the edge's axis [m]; the others are those of the node
  std::uint32_t node;  ///< the node (i, j) of the layer where the edge starts: j * count(0) + i
  std::uint32_t layer : 30, axis : 2;
};

Vec3 position(const NodeGrid& grid, const EdgeVertex& vertex) {
  const auto row = static_cast<std::uint32_t>(grid.count(0));
  Vec3 p = grid.node(vertex.node % row, vertex.node / row, vertex.layer);
  p[vertex.axis] = vertex.along;
  return p;
}

/// The vertices on the edges from the layer of nodes below to this one, followed by those in this layer.
struct SurfaceLayer {
  std::vector<EdgeVertex> vertices;
  std::vector<Vec3> normals;  ///< as in IsoSurface
};

/// The part of a surface in consecutive layers of cells. The vertices in its last layer of nodes belong to the next
/// slab, if there is one, as its first. Vertices are numbered layer by layer, continued in the next slab.
struct SurfaceSlab {
  std::vector<SurfaceLayer> layers;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< numbered from this slab's first vertex, as are the cells
  CutCells cells;
};

/// One layer of the nodes of a grid, of equal z: the nodes inside, the crossed edges that start in them, and the
/// numbers of the vertices there. Each node is a bit: word w of row j holds the nodes (64 w …, j).
class GridLayer {
 public:
  /// The crossed edges that start in the nodes of a word, one bit each. Their vertices are numbered node by node, those
  /// along x and y together (x first), those along z separately.
  struct Edges {
    std::uint64_t x, y, z;
    std::uint32_t first_in_layer, first_along_z;
  };

  /// Field and grid must outlive the layer.
  GridLayer(const DensityField& field, const NodeGrid& grid)
      : field_(field),
        grid_(grid),
        words_((grid.count(0) + 63) / 64),
        starting_in_last_((std::uint64_t{1} << (grid.count(0) - 1) % 64) - 1),
        inside_(words_ * grid.count(1)),
        known_(words_ * grid.count(1)),
        edges_(words_ * grid.count(1)),
        density_(std::make_unique_for_overwrite<double[]>(64 * words_ * grid.count(1))) {}

  /// Becomes layer k: finds the nodes inside and the crossed edges along x and y. Returns the number of these edges.
  /// Cost: a few evaluations for each node next to the surface, and a few word operations for every 64 nodes.
  std::size_t evaluate(std::size_t k) {
    k_ = k;
    std::fill(inside_.begin(), inside_.end(), 0);
    std::fill(known_.begin(), known_.end(), 0);
    for (std::size_t j = 0; j < grid_.count(1); j += 64) {
      for (std::size_t i = 0; i < grid_.count(0); i += 64) find_inside(i, j, 64);
    }
    std::size_t count = 0;
    for (std::size_t j = 0; j < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < words_; ++w) {
        Edges& crossed = edges(w, j);
        crossed.x = (inside(w, j) ^ next_inside(w, j)) & starting(w);
        crossed.y = j + 1 < grid_.count(1) ? inside(w, j) ^ inside(w, j + 1) : 0;
        count += static_cast<std::size_t>(std::popcount(crossed.x) + std::popcount(crossed.y));
      }
    }
    return count;
  }
  /// Finds the crossed edges along z to the layer above. Returns their number.
  std::size_t cross_to(const GridLayer& above) {
    std::size_t count = 0;
    for (std::size_t word = 0; word < edges_.size(); ++word) {
      edges_[word].z = inside_[word] ^ above.inside_[word];
      count += static_cast<std::size_t>(std::popcount(edges_[word].z));
    }
    return count;
  }

  std::size_t words() const { return words_; }
  std::uint64_t inside(std::size_t w, std::size_t j) const { return inside_[j * words_ + w]; }
  /// The same for the next nodes along x.
  std::uint64_t next_inside(std::size_t w, std::size_t j) const {
    return inside(w, j) >> 1u | (w + 1 < words_ ? inside(w + 1, j) << 63u : 0);
  }
  /// The nodes of word w at which an edge along x starts: all but the row's last.
  std::uint64_t starting(std::size_t w) const { return w + 1 < words_ ? ~std::uint64_t{0} : starting_in_last_; }

  /// Positive inside. Evaluated on first use.
  double density(std::size_t i, std::size_t j) {
    if ((known_[j * words_ + i / 64] >> i % 64 & 1u) != 0) return density_[j * 64 * words_ + i];
    return set_density(i, j, field_.signed_distance(grid_.node(i, j, k_)));
  }

  Edges& edges(std::size_t w, std::size_t j) { return edges_[j * words_ + w]; }
  /// Number of the vertex on the crossed edge that starts at the node and runs along the axis.
  std::uint32_t vertex(std::size_t i, std::size_t j, std::size_t axis) const {
    const Edges& edges = edges_[j * words_ + i / 64];
    const std::uint64_t below = (std::uint64_t{1} << i % 64) - 1;
    const auto count = [](std::uint64_t bits) { return static_cast<std::uint32_t>(std::popcount(bits)); };
    if (axis == 2) return edges.first_along_z + count(edges.z & below);
    const bool along_x = axis == 1 && (edges.x >> i % 64 & 1u) != 0;
    return edges.first_in_layer + count(edges.x & below) + count(edges.y & below) + along_x;
  }

 private:
  double set_density(std::size_t i, std::size_t j, double distance) {
    known_[j * words_ + i / 64] |= std::uint64_t{1} << i % 64;
    return density_[j * 64 * words_ + i] =
               field_.density == Density::signed_distance ? -distance : (distance < 0.0 ? 0.5 : -0.5);
  }

  /// Finds the nodes inside among the square of `size` x `size` nodes from (i, j), which lies in one word of each row.
  void find_inside(std::size_t i, std::size_t j, std::size_t size) {
    const double half = 0.5 * grid_.spacing() * static_cast<double>(size - 1);
    const double distance = field_.signed_distance(grid_.node(i, j, k_) + Vec3(half, half, 0.0));
    // The square is all inside or all outside if the surface is further from its middle than its corners are. The slack
    // of 1e-9 covers the rounding of the distance.
    if (size > 1 && std::abs(distance) <= std::numbers::sqrt2 * half * (1.0 + 1e-9)) {
      for (const std::size_t y : {j, j + size / 2}) {
        for (const std::size_t x : {i, i + size / 2}) {
          if (x < grid_.count(0) && y < grid_.count(1)) find_inside(x, y, size / 2);
        }
      }
      return;
    }
    if (size == 1) set_density(i, j, distance);
    if (!(distance < 0.0)) return;
    const std::uint64_t bits = (size < 64 ? (std::uint64_t{1} << size) - 1 : ~std::uint64_t{0}) << i % 64;
    for (std::size_t y = j; y < std::min(j + size, grid_.count(1)); ++y) inside_[y * words_ + i / 64] |= bits;
  }

  const DensityField& field_;
  const NodeGrid& grid_;
  std::size_t words_, k_ = 0;
  std::uint64_t starting_in_last_;
  std::vector<std::uint64_t> inside_, known_;
  std::vector<Edges> edges_;
  std::unique_ptr<double[]> density_;  ///< of the known nodes
};

/// Maximum number of slabs, whatever the number of threads: the last digits of a normal that is summed in two slabs
/// depend on where they meet.
constexpr std::size_t kMostSlabs = 16;

/// Calls visit(i) for each set bit of the word that starts with node 64 w.
template <class Visit>
void for_each_node(std::uint64_t bits, std::size_t w, Visit visit) {
  for (; bits != 0; bits &= bits - 1) visit(64 * w + static_cast<std::size_t>(std::countr_zero(bits)));
}

/// A case of marching cubes, laid out for the loop over cells.
struct CutCase {
  struct Edge {
    std::uint8_t x, y, z, axis;  ///< x, y, z: corner where it starts, 0 or 1 each
  };
  std::vector<Edge> edges;                             ///< the crossed ones, in the order of their numbers
  std::vector<std::array<std::uint8_t, 3>> triangles;  ///< indices in `edges`

  explicit CutCase(unsigned inside) {
    const std::vector<CubeTriangle> all = cube_triangles(inside);
    std::array<std::uint8_t, 24> place{};
    for (std::uint8_t number = 0; number < 24; ++number) {
      const std::uint8_t corner = number / 3, axis = number % 3;
      const bool crossed =
          std::ranges::any_of(all, [&](const CubeTriangle& t) { return std::ranges::find(t, number) != t.end(); });
      if (!crossed) continue;
      place[number] = static_cast<std::uint8_t>(edges.size());
      edges.push_back({std::uint8_t(corner & 1), std::uint8_t(corner >> 1 & 1), std::uint8_t(corner >> 2), axis});
    }
    for (const auto& [a, b, c] : all) {
      const auto at = [&](int number) { return place[static_cast<std::size_t>(number)]; };
      triangles.push_back({at(a), at(b), at(c)});
    }
  }
};

const std::vector<CutCase>& cut_cases() {
  static const auto cases = [] {
    std::vector<CutCase> all;
    for (unsigned inside = 0; inside < 256; ++inside) all.emplace_back(inside);
    return all;
  }();
  return cases;
}

/// Two neighbouring layers of nodes, which a thread reuses for its slabs.
using LayerPair = std::array<GridLayer, 2>;

/// Makes a slab including the vertices in the layers of nodes at both ends, with sums of normals.
class SlabBuilder {
 public:
  SlabBuilder(const NodeGrid& grid, KeptOfSurface kept, LayerPair& layers, SurfaceSlab& slab)
      : grid_(grid), kept_(kept), low_(&layers[0]), high_(&layers[1]), slab_(slab) {}

  /// Adds the cells between the layers of nodes first < last. Returns the number of vertices in layer `last`.
  std::size_t build(std::size_t first, std::size_t last) {
    slab_.layers.resize(1 + last - first);
    above_ = slab_.layers.data();
    std::size_t in_layer = low_->evaluate(first);
    make_room(in_layer);
    add_vertices_in(*low_, first);
    for (std::size_t k = first; k < last; ++k) {
      in_layer = high_->evaluate(k + 1);
      first_below_ += below_ == nullptr ? 0 : below_->vertices.size();
      below_ = above_++;
      make_room(low_->cross_to(*high_) + in_layer);
      add_vertices_between(k);
      add_vertices_in(*high_, k + 1);
      add_cells(k);
      std::swap(low_, high_);
    }
    return in_layer;
  }

 private:
  /// Reserves room for all vertices of the layer above, because growing would hold many of them in memory twice.
  void make_room(std::size_t vertices) {
    above_->vertices.reserve(vertices);
    above_->normals.assign(vertices, Vec3::Zero());
  }

  /// Adds the vertex on the edge from a node of density a to the next one along the axis, of density b.
  void add_vertex(std::size_t i, std::size_t j, std::size_t k, unsigned axis, double a, double b) {
    const std::size_t node = std::array{i, j, k}[axis];
    const double p = grid_.coordinate(node, axis), q = grid_.coordinate(node + 1, axis);
    above_->vertices.push_back({p + (q - p) * (a / (a - b)), static_cast<std::uint32_t>(j * grid_.count(0) + i),
                                static_cast<std::uint32_t>(k) & 0x3fffffffu, axis & 3u});
  }

  /// Number of the next vertex in its layer.
  std::uint32_t next_vertex() const { return static_cast<std::uint32_t>(above_->vertices.size()); }

  void add_vertices_in(GridLayer& layer, std::size_t k) {
    for (std::size_t j = 0; j < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < layer.words(); ++w) {
        GridLayer::Edges& edges = layer.edges(w, j);
        edges.first_in_layer = next_vertex();
        for_each_node(edges.x | edges.y, w, [&](std::size_t i) {
          const double density = layer.density(i, j);
          if ((edges.x >> i % 64 & 1u) != 0) add_vertex(i, j, k, 0, density, layer.density(i + 1, j));
          if ((edges.y >> i % 64 & 1u) != 0) add_vertex(i, j, k, 1, density, layer.density(i, j + 1));
        });
      }
    }
  }

  void add_vertices_between(std::size_t k) {
    for (std::size_t j = 0; j < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < low_->words(); ++w) {
        GridLayer::Edges& edges = low_->edges(w, j);
        edges.first_along_z = next_vertex();
        for_each_node(edges.z, w,
                      [&](std::size_t i) { add_vertex(i, j, k, 2, low_->density(i, j), high_->density(i, j)); });
      }
    }
  }

  /// Adds the cells that the surface cuts among those whose lowest corners are in layer k.
  void add_cells(std::size_t k) {
    const std::vector<CutCase>& cases = cut_cases();
    for (std::size_t j = 0; j + 1 < grid_.count(1); ++j) {
      for (std::size_t w = 0; w < low_->words(); ++w) {
        // Element c is the word of corners c, numbered as in CubeTriangle.
        const std::array<std::uint64_t, 8> corners{
            low_->inside(w, j),  low_->next_inside(w, j),  low_->inside(w, j + 1),  low_->next_inside(w, j + 1),
            high_->inside(w, j), high_->next_inside(w, j), high_->inside(w, j + 1), high_->next_inside(w, j + 1)};
        std::uint64_t any = 0, all = ~std::uint64_t{0};
        for (const std::uint64_t corner : corners) {
          any |= corner;
          all &= corner;
        }
        for_each_node(any & ~all & low_->starting(w), w, [&](std::size_t i) {
          unsigned inside = 0;
          for (std::size_t c = 0; c < 8; ++c) inside |= static_cast<unsigned>(corners[c] >> i % 64 & 1u) << c;
          add_cell(i, j, k, cases[inside]);
        });
      }
    }
  }

  void add_cell(std::size_t i, std::size_t j, std::size_t k, const CutCase& cut) {
    const std::array x{grid_.coordinate(i, 0), grid_.coordinate(i + 1, 0)};
    const std::array y{grid_.coordinate(j, 1), grid_.coordinate(j + 1, 1)};
    const std::array z{grid_.coordinate(k, 2), grid_.coordinate(k + 1, 2)};
    std::array<std::uint32_t, 12> vertices;  // numbered in the slab
    std::array<Vec3*, 12> normals;
    std::array<Vec3, 12> positions;
    for (std::size_t e = 0; e < cut.edges.size(); ++e) {
      const CutCase::Edge& edge = cut.edges[e];
      const bool below = edge.z == 0 && edge.axis != 2;
      SurfaceLayer& layer = below ? *below_ : *above_;
      const std::uint32_t number = (edge.z == 0 ? low_ : high_)->vertex(i + edge.x, j + edge.y, edge.axis);
      vertices[e] = static_cast<std::uint32_t>(first_below_ + (below ? 0 : below_->vertices.size()) + number);
      normals[e] = &layer.normals[number];
      positions[e] = {x[edge.x], y[edge.y], z[edge.z]};
      positions[e][edge.axis] = layer.vertices[number].along;
    }
    for (const auto& [a, b, c] : cut.triangles) {
      const Vec3 normal = triangle_normal(positions[a], positions[b], positions[c]);
      for (const std::size_t corner : {a, b, c}) *normals[corner] += normal;
      if (kept_.triangles) slab_.triangles.push_back({vertices[a], vertices[b], vertices[c]});
    }
    if (kept_.cells) {
      CutCells& cells = slab_.cells;
      cells.centres.push_back(Vec3(x[0], y[0], z[0]) + Vec3::Constant(0.5 * grid_.spacing()));
      cells.vertices.insert(cells.vertices.end(), vertices.begin(),
                            vertices.begin() + static_cast<std::ptrdiff_t>(cut.edges.size()));
      cells.starts.push_back(static_cast<std::uint32_t>(cells.vertices.size()));
    }
  }

  const NodeGrid& grid_;
  KeptOfSurface kept_;
  GridLayer* low_;
  GridLayer* high_;
  SurfaceSlab& slab_;
  SurfaceLayer* below_ = nullptr;
  SurfaceLayer* above_ = nullptr;
  std::size_t first_below_ = 0;  ///< number in the slab of the layer below's first vertex
};

/// Moves the vertices that two slabs share, `in_last` of each, to the upper one, and normalises all normals.
void finish(std::vector<SurfaceSlab>& slabs, const std::vector<std::size_t>& in_last) {
  for (std::size_t s = 0; s + 1 < slabs.size(); ++s) {
    SurfaceLayer& last = slabs[s].layers.back();
    const std::size_t own = last.vertices.size() - in_last[s];
    std::vector<Vec3>& shared = slabs[s + 1].layers.front().normals;
    for (std::size_t i = 0; i < in_last[s]; ++i) shared[i] += last.normals[own + i];
    last.vertices.resize(own);
    last.normals.resize(own);
  }
  parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
    for (SurfaceLayer& layer : slabs[s].layers) {
      for (Vec3& normal : layer.normals) normal = unit_or(normal, normal);
    }
  });
}

/// The surface that marching_cubes returns, in slabs from the lowest z up, at most kMostSlabs for any number of
/// threads.
std::vector<SurfaceSlab> surface_slabs(const DensityField& field, const NodeGrid& grid, KeptOfSurface kept) {
  const std::size_t layers = grid.count(2) - 1, thickness = (layers + kMostSlabs - 1) / kMostSlabs;
  std::vector<SurfaceSlab> slabs((layers + thickness - 1) / thickness);
  std::vector<std::size_t> in_last(slabs.size());
  PerThread<LayerPair> layer_pairs([&] { return LayerPair{GridLayer(field, grid), GridLayer(field, grid)}; });
  parallel_for(std::size_t{0}, slabs.size(), [&](std::size_t s) {
    SlabBuilder builder(grid, kept, layer_pairs.local(), slabs[s]);
    in_last[s] = builder.build(s * thickness, std::min((s + 1) * thickness, layers));
  });
  finish(slabs, in_last);
  return slabs;
}

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

// On each face, a segment cuts off each run of inside corners: it leads from the edge where a walk around the face
// enters the run to the edge where it leaves the run. Every crossed edge is entered on one of its two faces and left on
// the other, so the segments form closed polygons.
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
  std::vector<CubeTriangle> triangles;
  for (std::size_t start = 0; start < next.size(); ++start) {
    std::vector<int> polygon;
    for (int edge = static_cast<int>(start); next[static_cast<std::size_t>(edge)] >= 0;) {
      polygon.push_back(edge);
      edge = std::exchange(next[static_cast<std::size_t>(edge)], -1);
    }
    if (polygon.empty() || triangulate(polygon, triangles)) continue;
    // Only a polygon that crosses one face twice has no diagonals through the inside.
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
