#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "sim/geometry/triangle_tree.hpp"
#include "sim/mesh/half_edge_mesh.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "sim/tool/mesh_tool.hpp"

/// Surfaces for tests, as lists of triangles without neighbour information. Closed surfaces have
/// counter-clockwise triangles, seen from outside.
namespace hapbench::test {

/// Returns the cube with corners at +-half around `centre`: 8 vertices, 12 triangles.
TriangleSoup cube(double half = 1.0, const Vec3& centre = Vec3::Zero());
/// Returns a sphere around the origin. Starts with an octahedron, divides each triangle into four triangles, `levels`
/// times, and projects all vertices onto the sphere.
TriangleSoup sphere(double radius, int levels);
/// Returns a grid of `n` x `m` quads with vertices position(i, j), i = 0 … n, j = 0 … m. Each quad is divided
/// into two triangles. Vertices with equal positions are not merged; the code under test must weld them.
TriangleSoup sheet(int n, int m, const std::function<Vec3(int, int)>& position);
TriangleSoup torus(int n, int m);
/// Return one-sided surfaces: a band with half a twist, and a Klein bottle, a closed tube that passes through itself.
TriangleSoup moebius_band(int n);
TriangleSoup klein_bottle(int n, int m);

/// Returns the triangles of both surfaces.
TriangleSoup together(TriangleSoup a, const TriangleSoup& b);
/// Returns the surface with the orientation of every triangle reversed.
TriangleSoup reversed(TriangleSoup soup);

/// Returns a random density field on a grid of 6 x 6 x 6 cells. Values at the nodes are independent and at most
/// 1e-9 in magnitude; nodes at the border are outside. The field has no structure, so that marching cubes meets
/// all 256 cases and skips no cell. Its surfaces have many components, handles and touching corners.
DensityField noise(std::uint64_t seed);

/// Returns the surface with neighbour information. OpenMesh only accepts manifolds: the test fails if a
/// triangle cannot be added. Precondition: the surface contains its triangles.
HalfEdgeMesh half_edge_mesh(const IsoSurface& surface);

/// Returns the enclosed volume by the divergence theorem. Positive for closed surfaces whose triangles are
/// counter-clockwise from outside.
double enclosed_volume(const HalfEdgeMesh& mesh);
double surface_area(const HalfEdgeMesh& mesh);
/// Returns vertices - edges + faces: 2 for a sphere, 0 for a torus.
long euler_characteristic(const HalfEdgeMesh& mesh);

/// Returns the surface that a closed polygon of (rho, z) sweeps about the z axis, in `sides` steps. Vertices on
/// the axis coincide.
TriangleSoup swept(const std::vector<std::pair<double, double>>& polygon, int sides);
/// Returns a cylinder with flat ends along z, from the tip at the origin to z = length.
TriangleSoup cylinder_mesh(double radius, double length, int sides);
/// Returns a concave solid: a cup of height 2 and radius 1, open at the top, with walls of thickness 0.3.
TriangleSoup cup(int sides);
TriangleSoup scaled(TriangleSoup soup, double factor, const Vec3& shift = Vec3::Zero());

std::shared_ptr<const SignedDistanceGrid> grid_of(const TriangleSoup& soup, double spacing);

/// Returns the signed distance to the triangles, by brute force. The sign is determined by the solid angle of
/// the triangles (van Oosterom and Strackee 1983).
double exact_distance(const TriangleSoup& soup, const Vec3& point);

}  // namespace hapbench::test
