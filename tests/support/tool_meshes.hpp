#pragma once

#include <memory>
#include <utility>

#include "sim/mesh/triangle_soup.hpp"
#include "sim/tool/mesh_tool.hpp"

/// Closed meshes of tools, in the tool's frame (axis along -z), and their exact distances by brute force.
namespace hapbench::test {

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
