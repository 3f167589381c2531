#pragma once

#include <numbers>
#include <vector>

#include "sim/core/math.hpp"

namespace hapbench {

/// The end of a solid of revolution: a plane, or beyond that plane half a ball of the same radius about the tip centre.
enum class Tip { flat, round };

/// A point of a solid of revolution's profile in the axial half plane [m].
struct ProfilePoint {
  double s;    ///< along the axis from the tip centre, <= 0 towards the shank
  double rho;  ///< distance from the axis, >= 0

  bool operator==(const ProfilePoint&) const = default;
};

/// Continues an outline that ends at {0, radius} with a quarter of a circle about the tip centre, as a polyline within
/// 0.013 % of the radius.
inline void add_round_tip(double radius, std::vector<ProfilePoint>& outline) {
  constexpr int kLegs = 48;
  for (int i = 1; i < kLegs; ++i) {
    const double angle = std::numbers::pi / 2.0 * i / kLegs;
    outline.push_back({radius * math::sin(angle), radius * math::cos(angle)});
  }
  outline.push_back({radius, 0.0});
}

}  // namespace hapbench
