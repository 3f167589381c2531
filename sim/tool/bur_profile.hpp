#pragma once

#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Shapes of dental rotary instruments, with the names of ISO 6360-2.
enum class BurFamily { ball, cylinder, round_cylinder, tapered, inverted_cone, pear, flame };

/// Profile and tip of a bur: the arguments of Revolved.
struct BurProfile {
  std::vector<ProfilePoint> profile;
  Tip tip;
};

/// Returns the profile of a bur with its shank. All lengths in m and > 0:
///
/// - diameter: largest diameter of the head, the nominal size of ISO 6360 (a "012" has 1.2 mm).
/// - length: length of the head along the axis, from its front end (including the half ball of a round tip) to the
///   beginning of the shank. The length of a ball bur equals the diameter; the neck hides a small part of the ball at
///   the rear.
/// - shank_diameter: diameter of the cylinder behind the head, called neck if it is thin. The length of this cylinder
///   is ten times its diameter.
///
/// | family | head, from the shank to the tip | tip centre |
/// |---|---|---|
/// | ball | a ball | centre of the ball |
/// | cylinder | a cylinder with a flat end | centre of the end |
/// | round_cylinder | a cylinder with a half ball at its end | centre of the ball |
/// | tapered | a cone frustum that narrows to 0.6 of the diameter, flat end | centre of the end |
/// | inverted_cone | a cone frustum that widens from 0.6 of the diameter, flat end | centre of the end |
/// | pear | a cone that widens from the shank and touches the ball at its end | centre of the ball |
/// | flame | an arc that widens to the diameter over the rear third, then an arc to a pointed tip | the pointed tip |
///
/// Arcs are polylines with corners on the arc and a sagitta (largest deviation from the arc) of at most a
/// thousandth of the diameter. Throws std::invalid_argument with the allowed range if a length is invalid for the
/// family.
BurProfile bur_profile(BurFamily family, double diameter, double length, double shank_diameter);

}  // namespace hapbench
