#pragma once

#include <vector>

#include "sim/geometry/point_shell.hpp"

/// Surfaces in closed form. For each surface, `surface_points` returns sample points, and `signed_distance` returns the
/// exact signed distance. Every edge of a surface is divided into equal intervals no longer than the spacing, with a
/// point at both ends. The normal of a point on an edge is the normalised mean of the normals of the two adjacent
/// faces. `point_count` returns the number of points without creating them, as a double, so that absurdly large numbers
/// can be rejected.
namespace hapbench {

/// Planar peg-in-hole scene of thesis section A.1.1, in the plane z = 0. The y axis points up; the mouth of the hole is
/// at y = 0, centred at x = 0. Point order: along the profile from the left end of the flat top, down the left wall,
/// along the bottom, up the right wall, to the right end of the flat top. The thesis gives the width (1 mm) and the
/// spacing (0.1 mm). The depth, the length of the flat top and the 45 degree normals at edges are assumptions of this
/// project.
struct Hole2d {
  double width = 0.001;     ///< [m]
  double depth = 0.005;     ///< [m]
  double spacing = 0.0001;  ///< [m]
  double mouth = 0.003;     ///< length of the flat top on either side of the hole [m]
};

/// Square |x|, |y| <= size / 2 in the plane z = 0 with normal +z. Point order: x is the outer loop, y the inner
/// loop.
struct Plane {
  double size = 0.01;
  double spacing = 0.0001;
};

/// Slot between two parallel faces x = -gap/2 (normal +x) and x = +gap/2 (normal -x), with |y| <= length / 2 and
/// -depth <= z <= 0. Used for the drill between two walls in section 4.6 of the thesis. Point order: left face first;
/// in a face, y is the outer loop and z the inner loop.
struct Slot {
  double gap = 0.001;
  double depth = 0.005;
  double length = 0.01;
  double spacing = 0.0001;
};

/// Conical hole about the z axis with its apex at z = -depth and its mouth at z = 0. Normals point into the hole;
/// the normal at the apex is +z. Point order: ring by ring from the apex. The points of a ring have equal angles
/// between them, and their number is a multiple of four, so that a rotation by 90 degrees about z maps the points
/// onto themselves bit for bit. `point_count` of this surface is an upper bound.
struct ConicalHole {
  double half_angle = 0.5;  ///< angle between axis and wall [rad], in (0, pi/2)
  double depth = 0.003;     ///< [m]
  double spacing = 0.0001;  ///< [m]
};

/// Number of points that surface_points() would return; an upper bound for ConicalHole.
double point_count(const Hole2d& hole);
double point_count(const Plane& plane);
double point_count(const Slot& slot);
double point_count(const ConicalHole& cone);

/// Points on the surface with outward normals, in the order documented at the struct.
std::vector<SurfacePoint> surface_points(const Hole2d& hole);
std::vector<SurfacePoint> surface_points(const Plane& plane);
std::vector<SurfacePoint> surface_points(const Slot& slot);
std::vector<SurfacePoint> surface_points(const ConicalHole& cone);

// Signed distance of a point from the exact surface [m], negative in the material. Where the material is: below the
// Plane; at |x| > gap / 2 for the Slot; below the flat top of the Hole2d, except in the hole; outside the cone of the
// ConicalHole. Beyond the borders of these open surfaces (see solid.hpp), flat faces are continued as planes. The cone
// is not continued: its surface ends at its mouth.

double signed_distance(const Plane& plane, const Vec3& point);
double signed_distance(const Slot& slot, const Vec3& point);
double signed_distance(const Hole2d& hole, const Vec3& point);
double signed_distance(const ConicalHole& cone, const Vec3& point);

/// Validation object of thesis section 3.2: a cuboid centred at x = y = 0 with its top face in z = 0, and a round blind
/// hole along the z axis.
struct BlockWithHole {
  Vec3 size = {0.015, 0.015, 0.01};  ///< [m]
  double hole_diameter = 0.002;      ///< [m]
  double hole_depth = 0.005;         ///< [m]
};

/// Returns the exact signed distance of a point from the block's surface [m], negative inside the material.
double signed_distance(const BlockWithHole& block, const Vec3& point);

}  // namespace hapbench
