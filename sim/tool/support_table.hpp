#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// The foremost of many points along any direction: the support function of their convex hull.
///
/// Directions are sorted into 6 x 16 x 16 cells of a cube. A point v is foremost along some unit direction u of a cell
/// only if it is within reach of the point p that is foremost along the cell's middle c: from <u, v - p> >= 0 and |u -
/// c| <= r follows <c, p - v> <= r |v - p|. Each cell lists those points. Exact. A query takes the points of a cell,
/// some 4 r^2 of a round body's; building takes 1536 times the points, and is shared out among oneTBB's threads.
class SupportTable {
 public:
  /// Precondition: there are points.
  explicit SupportTable(std::vector<Vec3> points);

  /// max <direction, p> over the points [m]; the direction need not be a unit vector.
  double support(const Vec3& direction) const noexcept;
  /// The place of the hull that is foremost along the unit direction: of a foremost edge or face a place near
  /// the one nearest to `abreast`.
  Vec3 foremost(const Vec3& direction, const Vec3& abreast) const noexcept;

 private:
  std::span<const std::uint32_t> candidates(const Vec3& direction) const noexcept;

  std::vector<Vec3> points_;
  double tie_;  ///< points that far behind the foremost one are foremost, too [m]
  std::vector<std::uint32_t> starts_, listed_;
};

}  // namespace hapbench
