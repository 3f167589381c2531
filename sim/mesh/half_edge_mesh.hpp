#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <stdexcept>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

struct HalfEdgeMeshTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

/// Half-edge triangle mesh in double precision; coordinates in m, faces counter-clockwise seen from outside.
struct HalfEdgeMesh : OpenMesh::TriMesh_ArrayKernelT<HalfEdgeMeshTraits> {
  /// Splits an edge at the vertex `middle`, with the same result as the base class. The split of the base class
  /// checks every handle and takes twice as long.
  void split(OpenMesh::EdgeHandle edge, OpenMesh::VertexHandle middle);
};

/// Returns the vertices of the mesh in order, with outward normals. A normal is the normalised, unweighted mean of
/// the unit normals of the adjacent faces (thesis section C.1). Omits vertices without an adjacent face of positive
/// area.
std::vector<SurfacePoint> vertices_with_normals(const HalfEdgeMesh& mesh);

/// Splits the longest edge at its midpoint until no edge is longer than `longest_edge` [m]. Does not change the
/// surface. Precondition: longest_edge > 0.
void refine(HalfEdgeMesh& mesh, double longest_edge);

/// Returns the number of faces that the mesh would have after refine(). If this number exceeds `max_count`, returns
/// early with some number above `max_count`, so that absurdly large numbers can be rejected quickly.
double refined_face_count(const HalfEdgeMesh& mesh, double longest_edge, double max_count);

/// Returns a subsample of the points. Space is divided into cubes with edges of length `spacing` [m], bounded by
/// half-integer multiples of `spacing`. In each cube, the points are grouped by the axis direction (+x, -x, +y, …)
/// that is closest to their normal, so that both sides of a thin wall remain. Keeps one point of each group: the point
/// closest to the cube's centre, or the first of several equally close points. Preserves the order of the points.
/// O(n log n).
std::vector<SurfacePoint> subsampled(const std::vector<SurfacePoint>& points, double spacing);

/// Connected component of a surface: triangles that are connected across edges with two triangles.
struct MeshComponent {
  std::size_t triangles = 0;
  Box box;  ///< bounding box [m]
  /// True if the component ends at no edge. False if it is open, or ends at an edge with more than two triangles.
  bool is_closed = true;
  bool is_cavity = false;    ///< true if the component is closed, with normals towards its inside
  bool is_reversed = false;  ///< true if the component is closed, and its winding was reversed
  /// True if the component is closed but encloses no volume, such as the two sides of a sheet that are divided into
  /// different triangles.
  bool is_flat = false;

  double diameter() const { return box.size().norm(); }
};

/// Repairs made by mesh_from_triangles() and irregularities that it found.
struct MeshFindings {
  std::size_t degenerate_triangles = 0;  ///< triangles with two equal corners; omitted
  std::size_t repeated_triangles = 0;    ///< triangles with the corners and the winding of an earlier triangle; omitted
  std::size_t opposite_triangles = 0;    ///< triangles with the corners of an earlier triangle, reversed; omitted
  bool is_double_sided = false;          ///< true if every triangle was present in both windings
  std::size_t flipped_triangles = 0;     ///< triangles wound against the majority of their connected part; reversed
  /// Closed parts that were reversed, because their normals or the normals of the part around them pointed inwards.
  std::size_t inverted_parts = 0;
  /// Midpoints [m] of the edges with more than two triangles (non-manifold edges). The surface is cut along them.
  std::vector<Vec3> non_manifold_edges = {};
  /// Midpoints [m] of the edges with one triangle only, where the surface is open.
  std::vector<Vec3> open_edges = {};
  std::size_t component_count = 0;
  std::size_t open_component_count = 0;  ///< components that are not closed: the file decides where their normals point
  /// The components in order of decreasing diameter; only the first kMaxComponents.
  std::vector<MeshComponent> components = {};
};
/// Maximum number of components that MeshFindings::components describes.
inline constexpr std::size_t kMaxComponents = 20;

/// Result of mesh_from_triangles().
struct CheckedMesh {
  HalfEdgeMesh mesh;
  MeshFindings findings;
};

/// Thrown if triangles form no surface with an inside and an outside. The message reports the reason and the
/// position.
class MeshError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Connects triangles to a surface.
///
/// - Triangles: keeps the first of several triangles with the same corners, in any winding.
/// - Vertices: merges vertices at the same position and omits unused vertices; keeps the order of the others. If
/// several triangle fans touch in one point only, each fan gets a vertex of its own.
/// - Edges: an edge with more than two triangles does not connect these triangles. They belong to different fans, and
/// each fan gets a vertex of its own.
/// - Winding: makes the winding of each connected part consistent, following the majority of its triangles. Orients
/// closed parts outwards. A closed part inside a larger closed part may be a cavity, and is therefore reversed if and
/// only if the larger part is reversed. `flip_open`: true to reverse the parts that are not closed.
///
/// Throws MeshError if there are no triangles, a coordinate is not finite, the surface is not orientable (a Moebius
/// band), or more than 10,000 triangles meet in one vertex (which would take quadratic time). O(n log n) otherwise.
/// Precondition: vertex indices are valid.
CheckedMesh mesh_from_triangles(const TriangleSoup& soup, bool flip_open = false);

/// Returns the triangles of the component with the largest diameter; of several equally large components, the first.
/// The result contains all vertices of the mesh, also those of other components.
TriangleSoup largest_component(const HalfEdgeMesh& mesh);

}  // namespace hapbench
