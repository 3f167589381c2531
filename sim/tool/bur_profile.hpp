#pragma once

#include <vector>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The shapes of rotary instruments that ISO 6360-2 numbers and dentists know by these names.
enum class BurFamily { ball, cylinder, round_cylinder, tapered, inverted_cone, pear, flame };

/// The arguments of Revolved.
struct BurProfile {
  std::vector<ProfilePoint> profile;
  Tip tip;
};

/// The profile of a bur with its shank. Lengths in metres, all > 0:
///
/// - diameter: the largest of the head, ISO 6360's nominal size (a "012" has 1.2 mm);
/// - length: of the head along the axis, from the foremost place to where the shank begins, including half a ball
///   at the tip. For a ball bur it is the diameter, from which the neck cuts a little off at the rear;
/// - shank_diameter: of the cylinder behind the head, called neck if it is thin; the shank is ten times as long.
///
/// | family | head, from the shank to the tip | tip centre |
/// |---|---|---|
/// | ball | a ball | the ball's centre |
/// | cylinder | a cylinder with a flat end | the end's centre |
/// | round_cylinder | a cylinder with half a ball at its end | the ball's centre |
/// | tapered | a cone frustum that narrows to 0.6 of the diameter, flat end | the end's centre |
/// | inverted_cone | a cone frustum that widens from 0.6 of the diameter, flat end | the end's centre |
/// | pear | widens from the shank along a cone that touches the ball at its end | the ball's centre |
/// | flame | two arcs: from the shank to the diameter in the rear third, and from there to a point | the point |
///
/// Arcs are polylines with their corners on the arc and a sagitta of at most a thousandth of the diameter. Throws
/// std::invalid_argument that says which length does not suit the family.
BurProfile bur_profile(BurFamily family, double diameter, double length, double shank_diameter);

}  // namespace hapbench
