#include "sim/mesh/mesh_from_triangles.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <optional>
#include <sstream>

#include "sim/mesh/mesh_parts.hpp"

namespace hapbench {
namespace {

using Triangle = TriangleSoup::Triangle;

/// More around one vertex than any sensible mesh has; finding an edge takes time in proportion.
constexpr std::size_t kMostTrianglesAtVertex = 10'000;

std::string text(const Vec3& p) {
  std::ostringstream stream;
  stream << "(" << p.x() << ", " << p.y() << ", " << p.z() << ") m";
  return stream.str();
}

void require_finite(const TriangleSoup& soup) {
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    if (!soup.vertices[i].allFinite()) throw MeshError("vertex " + std::to_string(i) + " is not finite");
  }
}

/// For each vertex the first one at its position.
std::vector<std::uint32_t> first_at_position(const std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return before(vertices[a], vertices[b]); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

/// The triangles with equal positions welded, without those that have an edge of no length.
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

/// Each triangle's side i runs from corner i to the next; the sides of one edge lie side by side.
struct Side {
  std::uint32_t low, high;  ///< vertices, low < high
  std::uint32_t triangle;
  std::uint32_t corner;  ///< where it starts
  bool forward;          ///< from low to high
};

std::vector<Side> sides_by_edge(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangles[t][i], to = triangles[t][(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), t, i, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  return sides;
}

/// Pairs of triangles at the edges that have two; notes the other edges.
std::vector<Hinge> hinges_of(const std::vector<Side>& sides, const std::vector<Vec3>& vertices, MeshFindings& found) {
  std::vector<Hinge> hinges;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    const auto same_edge = [&](std::size_t j) {
      return sides[j].low == sides[i].low && sides[j].high == sides[i].high;
    };
    for (end = i + 1; end < sides.size() && same_edge(end);) ++end;
    const Vec3 middle = 0.5 * (vertices[sides[i].low] + vertices[sides[i].high]);
    if (end - i == 1) found.open_edges.push_back(middle);
    if (end - i > 2) found.crowded_edges.push_back(middle);
    if (end - i == 2) {
      const Side &a = sides[i], &b = sides[i + 1];
      hinges.push_back({{a.triangle, b.triangle}, {a.corner, b.corner}, a.forward != b.forward});
    }
  }
  return hinges;
}

/// Corners of triangles as classes of those that are one vertex of the surface: corner 3 t + i is corner i of triangle
/// t. Corners are joined across hinges, so that every class is one fan: a half-edge mesh holds any such surface,
/// because at most two sides of an edge, the ends of an open fan, have the same vertices, and they run in opposite
/// directions.
class Fans {
 public:
  explicit Fans(std::size_t triangles) : parent_(3 * triangles) { std::iota(parent_.begin(), parent_.end(), 0u); }

  std::uint32_t root(std::uint32_t corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }

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

/// The mesh's vertex of each corner; adds the vertices, in the order of the file's.
std::vector<OpenMesh::VertexHandle> add_vertices(HalfEdgeMesh& mesh, const std::vector<Vec3>& vertices,
                                                 const std::vector<Triangle>& triangles, Fans& fans) {
  std::vector<std::uint32_t> order(3 * triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto vertex = [&](std::uint32_t corner) { return triangles[corner / 3][corner % 3]; };
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return vertex(a) < vertex(b); });
  std::vector<OpenMesh::VertexHandle> handles(order.size());
  std::vector<std::size_t> count(order.size(), 0);
  for (const std::uint32_t corner : order) {
    const std::uint32_t root = fans.root(corner);
    const Vec3& p = vertices[vertex(corner)];
    if (!handles[root].is_valid()) handles[root] = mesh.add_vertex({p.x(), p.y(), p.z()});
    if (++count[root] > kMostTrianglesAtVertex) {
      throw MeshError("more than " + std::to_string(kMostTrianglesAtVertex) + " faces meet in the vertex at " +
                      text(p));
    }
    handles[corner] = handles[root];
  }
  return handles;
}

HalfEdgeMesh connected(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles, Fans& fans,
                       const std::vector<bool>& turned) {
  HalfEdgeMesh mesh;
  const auto handles = add_vertices(mesh, vertices, triangles, fans);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto &a = handles[3 * t], &b = handles[3 * t + 1], &c = handles[3 * t + 2];
    const auto face = turned[t] ? mesh.add_face(a, c, b) : mesh.add_face(a, b, c);
    if (!face.is_valid()) throw MeshError("the faces do not fit together at " + text(vertices[triangles[t][0]]));
  }
  return mesh;
}

}  // namespace

CheckedMesh mesh_from_triangles(const TriangleSoup& soup) {
  require_finite(soup);
  CheckedMesh result;
  const std::vector<Triangle> triangles = welded_triangles(soup);
  if (triangles.empty()) throw MeshError("has no faces; allowed: at least one, with three different corners");
  result.findings.degenerate_triangles = soup.triangles.size() - triangles.size();

  const std::vector<Hinge> hinges = hinges_of(sides_by_edge(triangles), soup.vertices, result.findings);
  MeshParts parts(triangles.size(), hinges);
  if (const auto hinge = parts.contradiction()) {
    const Triangle& t = triangles[hinge->triangles[0]];
    throw MeshError("is not orientable: no winding fits all faces around " + text(soup.vertices[t[hinge->corners[0]]]) +
                    "; allowed: a surface with two sides");
  }
  result.findings.rewound_triangles = parts.follow_majority();
  result.findings.inside_out_parts = parts.turn_outwards(soup.vertices, triangles);

  Fans fans(triangles.size());
  for (const Hinge& hinge : hinges) fans.join(hinge);
  result.mesh = connected(soup.vertices, triangles, fans, parts.turned());
  return result;
}

}  // namespace hapbench
