#pragma once

#include "sim/core/types.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {

/// Where a tool's mesh seems to have its tip.
struct TipOfMesh {
  Vec3 place;      ///< the end of its longest direction where it is thinner [m]
  Vec3 direction;  ///< out of the tip, a unit vector; a coordinate axis when it is near one
};

/// A guess, for a new scenario. Of a mesh that is longer in no direction than in others, the lowest place, along -z.
/// Precondition: it has triangles.
TipOfMesh guess_tip(const TriangleSoup& mesh);

}  // namespace hapbench
