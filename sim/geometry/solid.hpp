#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Signed distance of a point from a surface, with its validity.
struct SurfaceDistance {
  double value = 0.0;  ///< signed distance phi [m], negative inside
  /// False if the point lies beyond the border of an open surface. `value` is then the distance from a continuation
  /// of the surface, or its sign is a guess.
  bool known = true;
};

/// Signed distance computed earlier at a nearby point, used to shorten the next search. The distance from another
/// point to the surface is at most |value| plus the distance between the two points. A point closer to `point` than
/// |value| lies on the same side of the surface as `point`.
struct KnownDistance {
  /// Point at which the distance was computed [m].
  Vec3 point;
  /// Signed distance at `point` [m].
  double value;
};

/// Solid body of the environment: the signed distance phi from its true surface, which the point shell only
/// samples. Exact for scenes in closed form and for meshes. For a body that is given by points only, the error is
/// about the distance between neighbouring points. Immutable and safe for concurrent use by several threads.
class Solid {
 public:
  virtual ~Solid() = default;
  /// Returns the signed distance at a point. `near`: a distance known at a nearby point, which shortens the search,
  /// or null. Allocates nothing.
  virtual SurfaceDistance at(const Vec3& point, const KnownDistance* near = nullptr) const noexcept = 0;
  /// Box that contains every point known to be inside the body [m].
  const Box& region() const noexcept { return region_; }
  /// Upper bound of the error of a distance [m].
  virtual double error() const noexcept { return 0.0; }
  /// Approximate memory use in bytes.
  virtual std::size_t bytes() const noexcept { return 0; }
  /// Upper bound of the depth of all points in the box [m], without evaluating the distance; infinity if no bound is
  /// known.
  virtual double max_depth_in(const Box&) const noexcept { return std::numeric_limits<double>::infinity(); }
  /// Returns the unit gradient of phi: it points away from the surface outside of the body and towards the surface
  /// inside. The default computes it by central differences over `step` [m] and returns +z if they vanish. `near`: as
  /// in at().
  virtual Vec3 gradient(const Vec3& point, double step, const KnownDistance* near = nullptr) const noexcept;

 protected:
  explicit Solid(const Box& region) : region_(region) {}
  void set_region(const Box& region) { region_ = region; }

 private:
  Box region_;
};

/// Solids in closed form (signed_distance in analytic_shells.hpp), valid at any depth below their surfaces. Points at
/// which the distance is known: for the Plane, above and below the square; for the Slot, with |y| <= length / 2 and
/// -depth <= z <= 0, at any x; for the Hole2d, between the ends of the flat top in x; for the ConicalHole, above and
/// below its mouth; for the BlockWithHole, all points.
std::unique_ptr<const Solid> make_solid(const Plane& plane);
std::unique_ptr<const Solid> make_solid(const Slot& slot);
std::unique_ptr<const Solid> make_solid(const Hole2d& hole);
std::unique_ptr<const Solid> make_solid(const ConicalHole& cone);
std::unique_ptr<const Solid> make_solid(const BlockWithHole& block);

/// Solid bounded by a triangle mesh (vertices in m). `is_closed`: true if the mesh has no border and no edge with
/// more than two triangles; false if this is not known. For a closed mesh, phi < 0 where the winding number is at
/// least 1. For an open mesh, phi < 0 where the normal at the closest point of the surface points away from the
/// query point; phi is known unless that closest point lies on the border. A query takes about 0.3 us; construction
/// is O(n log n).
std::unique_ptr<const Solid> make_solid(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles,
                                        bool is_closed = false);

/// Solid given by points with normals. Let p be the point of the shell closest to the query point q, n its normal,
/// and q - p = h n + t with t perpendicular to n. Then phi has the sign of h and the absolute value sqrt(h^2 +
/// max(0, |t|^2 - s^2)). The constant s is twice the median distance between neighbouring points: a tangential
/// distance |t| <= s is explained by the gaps between points. phi is unknown if |t| > s and no point lies near p +
/// 2 s t/|t|.
std::unique_ptr<const Solid> make_solid(const std::vector<SurfacePoint>& points);

}  // namespace hapbench
