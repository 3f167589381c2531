#pragma once

#include <vector>

#include "sim/geometry/point_shell.hpp"

/// Surfaces known in closed form, as point shells and as a signed distance. Every edge is divided into equal intervals
/// no longer than the spacing, so that both of its ends carry a point; a point on an edge carries the normalised mean
/// of the two faces' normals. `point_count` returns the size in advance, as a double, so that absurd sizes can be
/// refused.
namespace hapbench {

/// The planar peg-in-hole scene of thesis A.1.1, in the plane z = 0 with y up and the mouth at y = 0, centred at x = 0.
/// Point order: along the profile from the left end of the flat top, down the left wall, along the bottom, up the right
/// wall, to the right end. Depth, mouth and the edges' 45 degree normals are our choices; the thesis gives the width
/// (1 mm) and the spacing (0.1 mm).
struct Hole2d {
  double width = 0.001;     ///< [m]
  double depth = 0.005;     ///< [m]
  double spacing = 0.0001;  ///< [m]
  double mouth = 0.003;     ///< flat top either side of the hole [m]
};

/// The square |x|, |y| <= size / 2 in the plane z = 0, normal +z. Point order: y fastest.
struct Plane {
  double size = 0.01;
  double spacing = 0.0001;
};

/// Two parallel faces x = -gap/2 (normal +x) and x = +gap/2 (normal -x), |y| <= length / 2, -depth <= z <= 0: the drill
/// between two walls of thesis 4.6. Point order: left face first, then y, z fastest.
struct Slot {
  double gap = 0.001;
  double depth = 0.005;
  double length = 0.01;
  double spacing = 0.0001;
};

/// A conical hole about z, its apex downwards at z = -depth and its mouth at z = 0; normals point into the hole, +z at
/// the apex. Point order: ring by ring from the apex; the points of a ring at equal angles, a multiple of four of them,
/// so that a quarter turn about z maps the shell to itself to the bit. Its `point_count` is an upper bound.
struct ConicalHole {
  double half_angle = 0.5;  ///< between axis and wall [rad], in (0, pi/2)
  double depth = 0.003;     ///< [m]
  double spacing = 0.0001;  ///< [m]
};

double point_count(const Hole2d& hole);
double point_count(const Plane& plane);
double point_count(const Slot& slot);
double point_count(const ConicalHole& cone);

std::vector<SurfacePoint> surface_points(const Hole2d& hole);
std::vector<SurfacePoint> surface_points(const Plane& plane);
std::vector<SurfacePoint> surface_points(const Slot& slot);
std::vector<SurfacePoint> surface_points(const ConicalHole& cone);

// Signed distances of the true surfaces [m], negative in the material: below the plane, behind the faces of the slot,
// below the top of the planar hole and outside the hole, outside the cone. Exact; beyond the borders of these surfaces
// (solid.hpp) they go on as flat as they were, the cone's as the distance to its mouth.

double signed_distance(const Plane& plane, const Vec3& point);
double signed_distance(const Slot& slot, const Vec3& point);
double signed_distance(const Hole2d& hole, const Vec3& point);
double signed_distance(const ConicalHole& cone, const Vec3& point);

/// The validation object of thesis 3.2: a cuboid centred at x = y = 0 with its top face in z = 0, and a round blind
/// hole down its middle.
struct BlockWithHole {
  Vec3 size = {0.015, 0.015, 0.01};  ///< [m]
  double hole_diameter = 0.002;      ///< [m]
  double hole_depth = 0.005;         ///< [m]
};

/// Exact signed distance to the block's surface [m], negative inside the material.
double signed_distance(const BlockWithHole& block, const Vec3& point);

}  // namespace hapbench
