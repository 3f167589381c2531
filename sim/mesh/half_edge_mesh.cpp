#include "sim/mesh/half_edge_mesh.hpp"

#include <Eigen/Geometry>
#include <OpenMesh/Tools/Subdivider/Uniform/LongestEdgeT.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "sim/core/hash.hpp"
#include "sim/tool/closed_surface.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

Vec3 position(const HalfEdgeMesh& mesh, OpenMesh::VertexHandle vertex) {
  const auto& p = mesh.point(vertex);
  return {p[0], p[1], p[2]};
}

/// Key of a group of points in subsampled(). The first three numbers are the centre of the cube that contains the
/// points, divided by the cube's edge length. The other two are the axis and the sign of the largest component of the
/// points' normals.
using CubeKey = std::array<double, 5>;

struct CubeKeyHash {
  std::size_t operator()(const CubeKey& key) const noexcept {
    Hash64 hash;
    for (const double number : key) hash.real(number + 0.0);  // 0 and -0 are the same coordinate
    return static_cast<std::size_t>(hash.value());
  }
};

CubeKey key_of(const Vec3& cube, const Vec3& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return {cube.x(), cube.y(), cube.z(), static_cast<double>(axis), normal[axis] < 0.0 ? -1.0 : 1.0};
}

using Triangle = TriangleSoup::Triangle;

/// Two triangles with a common edge.
struct Hinge {
  std::array<std::uint32_t, 2> triangles;
  std::array<std::uint32_t, 2> corners;  ///< corner of each triangle at which the edge starts
  /// True if the triangles run along the edge in opposite directions, as consistently wound neighbours do.
  bool opposed;
};

constexpr std::uint32_t kNone = 0xffffffffu;
/// Maximum number of parts whose bounding boxes are tested for enclosing other parts. Without this limit, a mesh with a
/// million small parts would take minutes.
constexpr std::size_t kMaxEnclosingParts = 1000;

/// Returns for each triangle and corner the index of the hinge at the edge from this corner; kNone if there is
/// none.
std::vector<std::array<std::uint32_t, 3>> hinges_at_triangles(std::size_t triangles, const std::vector<Hinge>& hinges) {
  std::vector<std::array<std::uint32_t, 3>> at(triangles, {kNone, kNone, kNone});
  for (std::uint32_t h = 0; h < hinges.size(); ++h) {
    for (std::size_t side = 0; side < 2; ++side) at[hinges[h].triangles[side]][hinges[h].corners[side]] = h;
  }
  return at;
}

/// Properties of a connected part that determine its orientation.
struct Shape {
  Box box = Box::nothing();
  double volume = 0.0;  ///< enclosed volume [m^3]; negative if normals point inwards
  double area = 0.0;    ///< area of all triangles [m^2]
  std::size_t triangles = 0;
  bool is_reversed = false;  ///< the winding of the part was reversed, after the volume was computed
  /// Centres of three triangles of the part [m]: if two of them are inside another part, this part is inside it. One of
  /// them may lie on the surface of the other part.
  std::array<Vec3, 3> samples = {};

  double size() const { return box.size().norm(); }
  bool box_holds(const Shape& other) const {
    return (other.box.min.array() >= box.min.array()).all() && (other.box.max.array() <= box.max.array()).all();
  }
  /// The threshold is larger than the rounding error of the volume. A part that consists of two coincident sheets, and
  /// so encloses no volume, therefore does not count as inside out.
  bool is_inside_out() const { return volume < -1e-12 * size() * size() * size(); }
  /// The volume counts as zero up to the area times a millionth of the size. A plane quadrilateral whose two sides are
  /// divided along different diagonals can enclose this volume, if the file rounds coordinates to six or seven digits.
  bool encloses_nothing() const { return std::abs(volume) <= 1e-6 * size() * area; }
};

/// A closed part as a solid, for the test whether it encloses points.
class PartSolid {
 public:
  /// `vertices` must outlive this object; `triangles` are the triangles of the part.
  PartSolid(const std::vector<Vec3>& vertices, std::vector<Triangle> triangles)
      : vertices_(vertices), triangles_(std::move(triangles)), tree_(vertices_, triangles_) {}

  /// Returns true if the surface of the part winds around the point [m], in either direction.
  bool holds(const Vec3& point) const { return tree_.winding_number(point, vertices_, triangles_) != 0; }

 private:
  const std::vector<Vec3>& vertices_;
  std::vector<Triangle> triangles_;
  TriangleTree tree_;
};

/// Connected parts of a surface, and the triangles to reverse so that each part is wound consistently.
class MeshParts {
 public:
  /// Finds the parts, and marks the triangles to reverse so that all neighbours agree with the first triangle of their
  /// part. `sides`: the sides of all triangles, by edge. O(triangles).
  MeshParts(std::size_t triangles, const std::vector<Hinge>& hinges, const std::vector<TriangleSide>& sides)
      : hinges_(hinges), part_(triangles, kNone), reversed_(triangles, false) {
    const auto at = hinges_at_triangles(triangles, hinges);
    std::vector<std::uint32_t> open;
    for (std::uint32_t first = 0; first < triangles; ++first) {
      if (part_[first] != kNone) continue;
      const auto part = static_cast<std::uint32_t>(count());
      closed_.push_back(true);
      part_[first] = part;
      open.push_back(first);
      // Visit all triangles of the part by depth-first search from its first triangle.
      while (!open.empty()) {
        const std::uint32_t t = open.back();
        open.pop_back();
        for (const std::uint32_t h : at[t])
          if (h != kNone) visit_neighbour(t, hinges_[h], part, open);
      }
    }
    for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
      if (edge.size() != 2) note_open_parts(edge);
    });
  }

  /// Returns a hinge whose triangles cannot be wound consistently; the surface then has only one side. Empty if there
  /// is no such hinge.
  std::optional<Hinge> contradiction() const {
    for (const Hinge& hinge : hinges_) {
      const bool same_winding = reversed_[hinge.triangles[0]] == reversed_[hinge.triangles[1]];
      if (same_winding != hinge.opposed) return hinge;
    }
    return std::nullopt;
  }

  /// If most triangles of a part are marked for reversal, inverts the marks of all its triangles, so that the majority
  /// keeps its original winding. Returns the number of triangles that are then marked. Does not count triangles for
  /// which `has_opposite` is true, because the file holds them in both windings.
  std::size_t follow_majority(const std::vector<bool>& has_opposite) {
    // For each part: number of reversed triangles minus number of other triangles.
    std::vector<std::int64_t> balance(count(), 0);
    for (std::size_t t = 0; t < part_.size(); ++t) balance[part_[t]] += reversed_[t] ? 1 : -1;
    std::vector<bool> mostly_reversed(count());
    std::transform(balance.begin(), balance.end(), mostly_reversed.begin(), [](std::int64_t b) { return b > 0; });
    reverse(mostly_reversed);
    std::size_t count = 0;
    for (std::size_t t = 0; t < reversed_.size(); ++t) count += reversed_[t] && !has_opposite[t] ? 1u : 0u;
    return count;
  }

  /// Orients the closed parts outwards. A closed part inside a larger closed part is reversed if the larger part is
  /// reversed. Any other closed part is reversed if it encloses a negative volume. Only the kMaxEnclosingParts largest
  /// of these other parts are tested for enclosing smaller parts. Returns the number of reversed parts.
  std::size_t orient_outwards(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
    measure_shapes(vertices, triangles);
    std::vector<Shape>& shapes = shapes_;
    // Orient the parts from the largest to the smallest. A part inside an outermost part is reversed together with
    // the outermost part.
    std::vector<std::uint32_t> largest_first(count()), outermost;
    std::iota(largest_first.begin(), largest_first.end(), 0u);
    std::ranges::stable_sort(largest_first, std::greater(), [&](std::uint32_t p) { return shapes[p].size(); });
    std::vector<bool> inside_out(count(), false);
    std::unordered_map<std::uint32_t, PartSolid> solids;  // of outermost parts
    const auto encloses = [&](std::uint32_t q, std::uint32_t p) {
      if (!shapes[q].box_holds(shapes[p])) return false;
      auto solid = solids.find(q);
      if (solid == solids.end()) solid = solids.try_emplace(q, vertices, triangles_of(q, triangles)).first;
      return std::ranges::count_if(shapes[p].samples, [&](const Vec3& at) { return solid->second.holds(at); }) > 1;
    };
    for (const std::uint32_t p : largest_first) {
      if (!closed_[p]) continue;
      const auto outer =
          std::find_if(outermost.begin(), outermost.end(), [&](std::uint32_t q) { return encloses(q, p); });
      inside_out[p] = outer == outermost.end() ? shapes[p].is_inside_out() : inside_out[*outer];
      if (outer == outermost.end() && outermost.size() < kMaxEnclosingParts) outermost.push_back(p);
    }
    reverse(inside_out);
    for (std::size_t p = 0; p < shapes.size(); ++p) shapes[p].is_reversed = inside_out[p];
    return static_cast<std::size_t>(std::count(inside_out.begin(), inside_out.end(), true));
  }

  /// Adds the number of parts and the description of the largest parts to the findings. Precondition: orient_outwards()
  /// was called.
  void describe(MeshFindings& found) const {
    found.component_count = count();
    found.open_component_count = static_cast<std::size_t>(std::ranges::count(closed_, false));
    std::vector<std::uint32_t> order(count());
    std::iota(order.begin(), order.end(), 0u);
    const std::size_t described = std::min(count(), kMaxComponents);
    std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(described), {},
                              [&](std::uint32_t p) { return std::pair(-shapes_[p].size(), p); });
    for (std::size_t i = 0; i < described; ++i) {
      const std::uint32_t p = order[i];
      const Shape& shape = shapes_[p];
      const bool is_cavity = closed_[p] && shape.is_inside_out() != shape.is_reversed;
      const bool is_flat = closed_[p] && shape.encloses_nothing();
      found.components.push_back({shape.triangles, shape.box, closed_[p], is_cavity, shape.is_reversed, is_flat});
    }
  }

  /// Reverses the parts that are not closed.
  void reverse_open() {
    std::vector<bool> open(closed_);
    open.flip();
    reverse(open);
  }

  /// Flags of the triangles: true if the winding must be reversed.
  const std::vector<bool>& reversed() const { return reversed_; }

 private:
  std::size_t count() const { return closed_.size(); }
  /// Computes the bounding box, the volume and the other properties of each part.
  void measure_shapes(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
    shapes_.assign(count(), Shape{});
    std::vector<Shape>& shapes = shapes_;
    for (std::size_t t = 0; t < part_.size(); ++t) {
      ++shapes[part_[t]].triangles;
      for (const std::uint32_t corner : triangles[t]) shapes[part_[t]].box.add(vertices[corner]);
    }
    std::vector<std::size_t> seen(count(), 0);  // number of triangles of each part so far
    for (std::size_t t = 0; t < part_.size(); ++t) {
      Shape& shape = shapes[part_[t]];
      // Sum the volumes of the tetrahedra between the triangles and a corner of the part's box. A distant origin
      // would lose digits by cancellation.
      const auto& [i, j, k] = triangles[t];
      const Vec3 a = vertices[i] - shape.box.min, b = vertices[j] - shape.box.min, c = vertices[k] - shape.box.min;
      shape.volume += (reversed_[t] ? -1.0 : 1.0) * a.dot(b.cross(c)) / 6.0;
      shape.area += 0.5 * (b - a).cross(c - a).norm();
      const std::size_t n = seen[part_[t]]++;
      for (const std::size_t third : {0u, 1u, 2u})
        if (n == third * (shape.triangles - 1) / 2) shape.samples[third] = shape.box.min + (a + b + c) / 3.0;
    }
  }
  /// Adds the triangle beyond a hinge of triangle t to a part and to the `open` triangles, unless it has a part
  /// already.
  void visit_neighbour(std::uint32_t t, const Hinge& hinge, std::uint32_t part, std::vector<std::uint32_t>& open) {
    const std::uint32_t neighbour = hinge.triangles[hinge.triangles[0] == t ? 1 : 0];
    if (part_[neighbour] != kNone) return;
    part_[neighbour] = part;
    reversed_[neighbour] = hinge.opposed ? reversed_[t] : !reversed_[t];
    open.push_back(neighbour);
  }
  /// Marks the parts as open that end at an edge with one triangle or with more than two. A part passes through such an
  /// edge, and does not end there, if its triangles run along the edge equally often in both directions.
  void note_open_parts(std::span<const TriangleSide> edge) {
    std::map<std::uint32_t, std::int64_t> balances;  // of the parts at this edge
    for (const TriangleSide& side : edge)
      balances[part_[side.triangle]] += side.forward != reversed_[side.triangle] ? 1 : -1;
    for (const auto& [part, balance] : balances)
      if (balance != 0) closed_[part] = false;
  }
  /// Returns the triangles of a part, wound consistently.
  std::vector<Triangle> triangles_of(std::uint32_t part, const std::vector<Triangle>& triangles) const {
    std::vector<Triangle> of_part;
    for (std::size_t t = 0; t < part_.size(); ++t)
      if (part_[t] == part) {
        const auto& [a, b, c] = triangles[t];
        of_part.push_back(reversed_[t] ? Triangle{a, c, b} : Triangle{a, b, c});
      }
    return of_part;
  }
  void reverse(const std::vector<bool>& parts) {
    for (std::size_t t = 0; t < part_.size(); ++t) {
      if (parts[part_[t]]) reversed_[t] = !reversed_[t];
    }
  }

  const std::vector<Hinge>& hinges_;
  std::vector<std::uint32_t> part_;  ///< part number of each triangle
  std::vector<bool> reversed_;
  std::vector<bool> closed_;   ///< for each part: true if it ends at no edge
  std::vector<Shape> shapes_;  ///< properties of the parts
};

/// Maximum number of triangles at a vertex, larger than in any sensible mesh. The time to find an edge at a vertex is
/// proportional to this number.
constexpr std::size_t kMaxTrianglesAtVertex = 10'000;

std::string text(const Vec3& position) {
  return "(" + coordinates(position) + ") m";
}

/// Returns for each vertex the index of the first vertex at its position.
std::vector<std::uint32_t> first_at_position(const std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return before(vertices[a], vertices[b]); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

/// Returns the triangles with vertices at equal positions merged, without triangles that have two equal corners.
std::vector<Triangle> welded_triangles(const TriangleSoup& soup) {
  const std::vector<std::uint32_t> first = first_at_position(soup.vertices);
  std::vector<Triangle> welded;
  welded.reserve(soup.triangles.size());
  for (const Triangle& t : soup.triangles) {
    const Triangle w{first[t[0]], first[t[1]], first[t[2]]};
    if (w[0] != w[1] && w[1] != w[2] && w[2] != w[0]) welded.push_back(w);
  }
  return welded;
}

/// Triangles that have the same corners as an earlier triangle.
struct Copies {
  std::vector<bool> is_copy;       ///< true for triangles that are copies; empty if there are no copies
  std::vector<bool> has_opposite;  ///< true for triangles that have a copy with the opposite winding
};

/// Finds triangles with the same corners, and counts them in the findings.
Copies copies_in(const std::vector<Triangle>& triangles, const std::vector<TriangleSide>& sides, MeshFindings& found) {
  Copies copies{{}, std::vector<bool>(triangles.size(), false)};
  const auto third = [&](const TriangleSide& side) { return triangles[side.triangle][(side.corner + 2) % 3]; };
  std::vector<TriangleSide> same;
  for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
    if (edge.size() < 2 || (edge.size() == 2 && third(edge[0]) != third(edge[1]))) return;
    // Compare the triangles only at the edge between their two lowest vertices, so that each copy is found once.
    same.assign(edge.begin(), edge.end());
    std::erase_if(same, [&](const TriangleSide& side) { return third(side) < side.high; });
    std::ranges::stable_sort(same, {}, third);
    const TriangleSide* first = nullptr;
    for (const TriangleSide& side : same) {
      if (first == nullptr || third(*first) != third(side)) {
        first = &side;
        continue;
      }
      if (copies.is_copy.empty()) copies.is_copy.resize(triangles.size(), false);
      copies.is_copy[side.triangle] = true;
      if (side.forward == first->forward) ++found.repeated_triangles;
      if (side.forward == first->forward) continue;
      ++found.opposite_triangles;
      copies.has_opposite[first->triangle] = true;
    }
  });
  return copies;
}

/// Removes triangles that have the same corners as an earlier triangle, and removes their sides from `sides`. Returns
/// for each remaining triangle whether a copy with the opposite winding was removed.
std::vector<bool> drop_copies(std::vector<Triangle>& triangles, std::vector<TriangleSide>& sides, MeshFindings& found) {
  Copies copies = copies_in(triangles, sides, found);
  if (copies.is_copy.empty()) return copies.has_opposite;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (copies.is_copy[t]) continue;
    triangles[kept] = triangles[t];
    copies.has_opposite[kept++] = copies.has_opposite[t];
  }
  triangles.resize(kept);
  copies.has_opposite.resize(kept);
  sides = sides_by_edge(triangles);
  found.is_double_sided = std::ranges::count(copies.has_opposite, true) == static_cast<std::ptrdiff_t>(kept);
  return copies.has_opposite;
}

/// Returns a hinge for every edge that belongs to exactly two triangles. Adds the midpoints of all other edges to the
/// findings.
std::vector<Hinge> hinges_of(const std::vector<TriangleSide>& sides, const std::vector<Vec3>& vertices,
                             MeshFindings& found) {
  std::vector<Hinge> hinges;
  for_each_edge(sides, [&](std::span<const TriangleSide> edge) {
    const TriangleSide &a = edge.front(), &b = edge.back();
    const Vec3 middle = 0.5 * (vertices[a.low] + vertices[a.high]);
    if (edge.size() == 1) found.open_edges.push_back(middle);
    if (edge.size() > 2) found.non_manifold_edges.push_back(middle);
    if (edge.size() == 2) hinges.push_back({{a.triangle, b.triangle}, {a.corner, b.corner}, a.forward != b.forward});
  });
  return hinges;
}

/// Assigns the triangles' corners to vertices of the surface (union-find). Corner 3 t + i is corner i of triangle t.
/// Corners at the same end of a hinge's edge are joined, so the triangles around each vertex form one fan. A half-edge
/// mesh can represent the result, because at most one triangle side runs from a vertex a to a vertex b: if two sides
/// connect a and b, they belong to one hinge or are the two ends of an open fan, and run in opposite directions.
class Fans {
 public:
  explicit Fans(std::size_t triangles) : parent_(3 * triangles) { std::iota(parent_.begin(), parent_.end(), 0u); }

  /// Returns the representative corner of the vertex to which `corner` belongs, and shortens the path to it.
  std::uint32_t root(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }

  /// At each end of the hinge's edge, joins the corners of its two triangles.
  void join(const Hinge& hinge) {
    const auto [t, u] = hinge.triangles;
    const auto [i, j] = hinge.corners;
    const std::uint32_t t_from = 3 * t + i, t_to = 3 * t + (i + 1) % 3;
    const std::uint32_t u_from = 3 * u + j, u_to = 3 * u + (j + 1) % 3;
    join(t_from, hinge.opposed ? u_to : u_from);
    join(t_to, hinge.opposed ? u_from : u_to);
  }

 private:
  void join(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax({root(a), root(b)});
    parent_[high] = low;
  }

  std::vector<std::uint32_t> parent_;
};

/// Adds the vertices to the mesh, in the order of the soup. Returns the vertex of each corner.
std::vector<OpenMesh::VertexHandle> add_vertices(HalfEdgeMesh& mesh, const std::vector<Vec3>& vertices,
                                                 const std::vector<Triangle>& triangles, Fans& fans) {
  std::vector<std::uint32_t> order(3 * triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto vertex = [&](std::uint32_t corner) { return triangles[corner / 3][corner % 3]; };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return vertex(a) < vertex(b); });
  // Create a mesh vertex for the first corner of each fan; the other corners share it.
  std::vector<OpenMesh::VertexHandle> handles(order.size());
  std::vector<std::size_t> count(order.size(), 0);
  for (const std::uint32_t corner : order) {
    const std::uint32_t root = fans.root(corner);
    const Vec3& p = vertices[vertex(corner)];
    if (!handles[root].is_valid()) handles[root] = mesh.add_vertex({p.x(), p.y(), p.z()});
    if (++count[root] > kMaxTrianglesAtVertex) {
      throw MeshError("more than " + std::to_string(kMaxTrianglesAtVertex) + " faces meet in the vertex at " + text(p));
    }
    handles[corner] = handles[root];
  }
  return handles;
}

/// Returns the half-edge mesh of the triangles, with reversed winding where `reversed` is set. `edges`: number of edges
/// of the mesh.
HalfEdgeMesh connected(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles, std::size_t edges,
                       Fans& fans, const std::vector<bool>& reversed) {
  HalfEdgeMesh mesh;
  mesh.reserve(0, edges, triangles.size());
  const auto handles = add_vertices(mesh, vertices, triangles, fans);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto &a = handles[3 * t], &b = handles[3 * t + 1], &c = handles[3 * t + 2];
    const auto face = reversed[t] ? mesh.add_face(a, c, b) : mesh.add_face(a, b, c);
    if (!face.is_valid()) throw MeshError("the faces do not fit together at " + text(vertices[triangles[t][0]]));
  }
  return mesh;
}

}  // namespace

void HalfEdgeMesh::split(OpenMesh::EdgeHandle edge, OpenMesh::VertexHandle middle) {
  const auto triangle = [this](OpenMesh::FaceHandle face, const std::array<OpenMesh::HalfedgeHandle, 3>& sides) {
    set_halfedge_handle(face, sides[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      set_face_handle(sides[i], face);
      set_next_halfedge_handle(sides[i], sides[(i + 1) % 3]);
    }
  };
  // Shorten the edge so that it starts at `middle`, and add a new edge from `middle` to the old start.
  const auto forth = halfedge_handle(edge, 0), back = halfedge_handle(edge, 1);
  const auto start = to_vertex_handle(back);
  const auto to_start = new_edge(middle, start), from_start = opposite_halfedge_handle(to_start);
  set_halfedge_handle(middle, forth);
  set_vertex_handle(back, middle);
  // If there is a triangle on the left of the edge, divide it.
  if (is_boundary(forth)) {
    set_next_halfedge_handle(prev_halfedge_handle(forth), from_start);
    set_next_halfedge_handle(from_start, forth);
  } else {
    const auto second = next_halfedge_handle(forth), third = next_halfedge_handle(second);
    const auto out = new_edge(middle, to_vertex_handle(second));
    triangle(face_handle(forth), {forth, second, opposite_halfedge_handle(out)});
    triangle(new_face(), {third, from_start, out});
  }
  // If there is a triangle on the right of the edge, divide it.
  if (is_boundary(back)) {
    set_next_halfedge_handle(to_start, next_halfedge_handle(back));
    set_next_halfedge_handle(back, to_start);
    set_halfedge_handle(middle, to_start);
  } else {
    const auto second = next_halfedge_handle(back), third = next_halfedge_handle(second);
    const auto out = new_edge(middle, to_vertex_handle(second));
    triangle(new_face(), {second, opposite_halfedge_handle(out), to_start});
    triangle(face_handle(back), {back, out, third});
  }
  if (halfedge_handle(start) == forth) set_halfedge_handle(start, from_start);
}

std::vector<SurfacePoint> vertices_with_normals(const HalfEdgeMesh& mesh) {
  // Compute the unit normals of the faces.
  std::vector<Vec3> face_normals;
  face_normals.reserve(mesh.n_faces());
  for (const auto face : mesh.faces()) {
    auto corner = mesh.cfv_begin(face);
    const Vec3 a = position(mesh, *corner++), b = position(mesh, *corner++), c = position(mesh, *corner);
    face_normals.push_back(triangle_normal(a, b, c));
  }

  std::vector<SurfacePoint> points;
  points.reserve(mesh.n_vertices());
  for (const auto vertex : mesh.vertices()) {
    Vec3 sum = Vec3::Zero();
    for (auto face = mesh.cvf_iter(vertex); face.is_valid(); ++face)
      sum += face_normals[static_cast<std::size_t>(face->idx())];
    if (const Vec3 normal = unit_or(sum, Vec3::Zero()); !normal.isZero(0.0))
      points.push_back({position(mesh, vertex), normal});
  }
  return points;
}

void refine(HalfEdgeMesh& mesh, double longest_edge) {
  OpenMesh::Subdivider::Uniform::LongestEdgeT<HalfEdgeMesh, double> subdivider;
  subdivider.set_max_edge_length(longest_edge);
  subdivider(mesh, 1);
}

double refined_face_count(const HalfEdgeMesh& mesh, double longest_edge, double max_count) {
  // Return early if a lower bound from the area already exceeds max_count.
  const double largest = longest_edge * longest_edge;
  double area = 0.0, count = 0.0;
  for (const auto face : mesh.faces()) area += mesh.calc_face_area(face);
  // The equilateral triangle has the largest area of all triangles without an edge longer than `longest_edge`.
  const double lower_bound = area / (std::sqrt(3.0) / 4.0 * largest);
  if (lower_bound > max_count) return lower_bound;
  // Divide every triangle as refine() does, with the lengths of its sides only.
  std::vector<std::array<double, 3>> open;  // squared lengths of the sides of a triangle
  for (const auto face : mesh.faces()) {
    auto edge = mesh.cfe_begin(face);
    for (double& length : open.emplace_back()) length = mesh.calc_edge_sqr_length(*edge++);
    count += 1.0;
    while (!open.empty() && count <= max_count) {
      auto [a, b, c] = open.back();
      open.pop_back();
      if (b > a) std::swap(a, b);
      if (c > a) std::swap(a, c);
      if (a <= largest) continue;
      // The median to the longest side divides the triangle; `median` is its squared length. The neighbours of the
      // triangle have no influence: refine() always divides the longest edge of the mesh, which is the longest side of
      // both triangles at this edge.
      const double median = (2.0 * b + 2.0 * c - a) / 4.0;
      open.push_back({a / 4.0, b, median});
      open.push_back({a / 4.0, c, median});
      count += 1.0;
    }
    if (count > max_count) break;
  }
  return count;
}

std::vector<SurfacePoint> subsampled(const std::vector<SurfacePoint>& points, double spacing) {
  using Nearest = std::pair<double, std::size_t>;  // distance from the cube's centre [m], and index of the point
  // For each group of points with the same key (CubeKey), find the point closest to the centre of the cube.
  std::unordered_map<CubeKey, Nearest, CubeKeyHash> nearest;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 cube = (points[i].position / spacing + Vec3::Constant(0.5)).array().floor();
    const Nearest here{(points[i].position - spacing * cube).norm(), i};
    const auto [entry, is_new] = nearest.try_emplace(key_of(cube, points[i].normal), here);
    if (!is_new) entry->second = std::min(entry->second, here);
  }
  // Keep the found points in their original order.
  std::vector<std::size_t> kept;
  for (const auto& [key, point] : nearest) kept.push_back(point.second);
  std::sort(kept.begin(), kept.end());
  std::vector<SurfacePoint> thin;
  thin.reserve(kept.size());
  for (const std::size_t index : kept) thin.push_back(points[index]);
  return thin;
}

CheckedMesh mesh_from_triangles(const TriangleSoup& soup, bool flip_open) {
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    if (!soup.vertices[i].allFinite()) throw MeshError("vertex " + std::to_string(i) + " is not finite");
  }
  CheckedMesh result;
  // Merge vertices at equal positions, and omit degenerate triangles.
  std::vector<Triangle> triangles = welded_triangles(soup);
  if (triangles.empty()) throw MeshError("has no faces; allowed: at least one, with three different corners");
  result.findings.degenerate_triangles = soup.triangles.size() - triangles.size();

  // Wind each part consistently and outwards.
  std::vector<TriangleSide> sides = sides_by_edge(triangles);
  const std::vector<bool> has_opposite = drop_copies(triangles, sides, result.findings);
  const std::vector<Hinge> hinges = hinges_of(sides, soup.vertices, result.findings);
  MeshParts parts(triangles.size(), hinges, sides);
  if (const auto hinge = parts.contradiction()) {
    const Triangle& t = triangles[hinge->triangles[0]];
    throw MeshError("is not orientable: no winding fits all faces around " + text(soup.vertices[t[hinge->corners[0]]]) +
                    "; allowed: a surface with two sides");
  }
  result.findings.flipped_triangles = parts.follow_majority(has_opposite);
  result.findings.inverted_parts = parts.orient_outwards(soup.vertices, triangles);
  if (flip_open) parts.reverse_open();
  parts.describe(result.findings);

  // Build the half-edge mesh with one vertex for each triangle fan.
  Fans fans(triangles.size());
  for (const Hinge& hinge : hinges) fans.join(hinge);
  const std::size_t edges = 3 * triangles.size() - hinges.size();
  result.mesh = connected(soup.vertices, triangles, edges, fans, parts.reversed());
  return result;
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one search over the faces.
TriangleSoup largest_component(const HalfEdgeMesh& mesh) {
  // Find the components by depth-first search over the faces.
  std::vector<bool> seen(mesh.n_faces(), false);
  std::vector<OpenMesh::FaceHandle> largest, component;
  double largest_size = -1.0;
  for (const auto first : mesh.faces()) {
    if (seen[static_cast<std::size_t>(first.idx())]) continue;
    component.assign(1, first);
    seen[static_cast<std::size_t>(first.idx())] = true;
    Box box = Box::nothing();
    for (std::size_t i = 0; i < component.size(); ++i) {
      for (auto vertex = mesh.cfv_iter(component[i]); vertex.is_valid(); ++vertex) box.add(position(mesh, *vertex));
      for (auto next = mesh.cff_iter(component[i]); next.is_valid(); ++next) {
        if (seen[static_cast<std::size_t>(next->idx())]) continue;
        seen[static_cast<std::size_t>(next->idx())] = true;
        component.push_back(*next);
      }
    }
    if (box.size().norm() <= largest_size) continue;
    largest_size = box.size().norm();
    largest.swap(component);
  }
  // Keep the order of the faces.
  std::ranges::sort(largest, {}, [](OpenMesh::FaceHandle face) { return face.idx(); });
  TriangleSoup soup;
  for (const auto vertex : mesh.vertices()) soup.vertices.push_back(position(mesh, vertex));
  for (const auto face : largest) {
    auto corner = soup.triangles.emplace_back().begin();
    for (auto vertex = mesh.cfv_iter(face); vertex.is_valid(); ++vertex)
      *corner++ = static_cast<std::uint32_t>(vertex->idx());
  }
  return soup;
}

}  // namespace hapbench
