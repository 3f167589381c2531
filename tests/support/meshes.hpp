#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

#include "sim/geometry/triangle_tree.hpp"
#include "sim/mesh/half_edge_mesh.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "sim/tool/mesh_tool.hpp"

/// Surfaces to test with, as loose triangles. Closed ones are wound counter-clockwise from outside.
namespace hapbench::test {

/// The cube with corners at +-half around `centre`: 8 vertices, 12 triangles.
TriangleSoup cube(double half = 1.0, const Vec3& centre = Vec3::Zero());
/// An octahedron whose triangles are quartered `levels` times and pushed out to the sphere around the origin.
TriangleSoup sphere(double radius, int levels);
/// A grid of `n` x `m` quads, bent by `position(i, j)`, i = 0 ... n, j = 0 ... m, each cut into two triangles. Equal
/// positions are for the code under test to weld.
TriangleSoup sheet(int n, int m, const std::function<Vec3(int, int)>& position);
TriangleSoup torus(int n, int m);
/// One-sided: a band with half a twist, and a tube that meets its own end inside out (it passes through itself).
TriangleSoup moebius_band(int n);
TriangleSoup klein_bottle(int n, int m);

/// Both in one soup.
TriangleSoup together(TriangleSoup a, const TriangleSoup& b);
/// Every triangle the other way round.
TriangleSoup reversed(TriangleSoup soup);

/// A field with a value of its own at every node of a grid of 6 x 6 x 6 cells, at most 1e-9 in size and outside at the
/// border: no structure, all 256 cases of marching cubes, no cell skipped; surfaces with many parts, handles and
/// touching corners.
DensityField noise(std::uint64_t seed);

/// The surface with its neighbours, which OpenMesh only builds of manifolds: fails the test if a triangle does not fit.
/// Precondition: the surface has its triangles.
HalfEdgeMesh half_edge_mesh(const IsoSurface& surface);

/// By the divergence theorem; positive for closed surfaces with outward winding.
double enclosed_volume(const HalfEdgeMesh& mesh);
double surface_area(const HalfEdgeMesh& mesh);
/// Vertices - edges + faces: 2 for a sphere, 0 for a torus.
long euler_characteristic(const HalfEdgeMesh& mesh);

/// The solid that a closed polygon of (rho, z) sweeps about z in `sides` steps. Vertices on the axis coincide.
TriangleSoup swept(const std::vector<std::pair<double, double>>& polygon, int sides);
/// Flat, from its tip at the origin to z = length.
TriangleSoup cylinder_mesh(double radius, double length, int sides);
/// Concave: a cup of height 2 and radius 1, open upwards, with walls 0.3 thick.
TriangleSoup cup(int sides);
TriangleSoup scaled(TriangleSoup soup, double factor, const Vec3& shift = Vec3::Zero());

std::shared_ptr<const SignedDistanceGrid> grid_of(const TriangleSoup& soup, double spacing);

/// The signed distance to the triangles, one by one, inside by the solid angle that they fill (van Oosterom and
/// Strackee 1983).
double exact_distance(const TriangleSoup& soup, const Vec3& point);

}  // namespace hapbench::test
