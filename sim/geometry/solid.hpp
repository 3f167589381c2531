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

/// Signed distance of a point from a surface.
struct SurfaceDistance {
  double value = 0.0;  ///< phi [m], negative inside
  /// False beyond the border of an open surface, where phi is that of the surface's continuation or its sign a guess.
  bool known = true;
};

/// A distance that was looked up at a place: the surface is no further from another place than that and the way there,
/// and another place nearer than the surface is on the same side.
struct LookedUp {
  Vec3 place;
  double value;
};

/// The inside of an environment: the signed distance phi of its true surface, of which the shell has only points. Exact
/// for scenes in closed form and for meshes, about a point's distance to its neighbours wrong for mere points.
/// Immutable; for several threads.
class Solid {
 public:
  virtual ~Solid() = default;
  /// Allocates nothing. `near`: a look-up not far away, which shortens the search; null for none.
  virtual SurfaceDistance at(const Vec3& point, const LookedUp* near = nullptr) const noexcept = 0;
  /// A box that contains all points that are known to be inside [m].
  const Box& region() const noexcept { return region_; }
  /// Largest error of a distance [m].
  virtual double error() const noexcept { return 0.0; }
  /// Approximate size in memory.
  virtual std::size_t bytes() const noexcept { return 0; }
  /// No point of the box is deeper than this [m]: what is known without a look.
  virtual double deepest_in(const Box&) const noexcept { return std::numeric_limits<double>::infinity(); }
  /// The unit gradient of phi, by differences over `step` [m] where nothing else tells: away from the surface where
  /// phi > 0, towards it inside.
  virtual Vec3 gradient(const Vec3& point, double step) const noexcept;

 protected:
  explicit Solid(const Box& region) : region_(region) {}
  void set_region(const Box& region) { region_ = region; }

 private:
  Box region_;
};

/// The solids of scenes in closed form (signed_distance in analytic_shells.hpp), at any depth below their surfaces.
/// Known within their borders: above and below the square; past the faces of the slot; between the ends of the planar
/// hole's top; above and below the cone's mouth.
std::unique_ptr<const Solid> make_solid(const Plane& plane);
std::unique_ptr<const Solid> make_solid(const Slot& slot);
std::unique_ptr<const Solid> make_solid(const Hole2d& hole);
std::unique_ptr<const Solid> make_solid(const ConicalHole& cone);
std::unique_ptr<const Solid> make_solid(const BlockWithHole& block);

/// The inside of a mesh. `is_closed`: it has no border, and no edge has more than two triangles; false when it is not
/// known. phi < 0 where a closed mesh winds around a point at least once, or where the nearest place of an open one has
/// its normal on the other side; known where that place is not on the border. A query takes 0.3 us; made in O(n log n).
std::unique_ptr<const Solid> make_solid(std::span<const Vec3> vertices, std::span<const TriangleCorners> triangles,
                                        bool is_closed = false);

/// The inside of points with normals. With q - p = h n + t for the nearest point p and its normal n, phi has the sign
/// of h and the size sqrt(h^2 + max(0, t^2 - s^2)), s being twice the usual distance of neighbours: t is the gap
/// between points as far as s explains it. phi is unknown where t is longer than s and no point lies 2 s further along
/// it.
std::unique_ptr<const Solid> make_solid(const std::vector<SurfacePoint>& points);

}  // namespace hapbench
