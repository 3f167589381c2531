#pragma once

#include "sim/core/types.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {

/// The guessed tip of a tool's mesh.
struct TipOfMesh {
  Vec3 place;      ///< the end of its longest direction where it is thinner [m]
  Vec3 direction;  ///< out of the tip, a unit vector
};

/// Guesses a tool's tip. A mesh without a longest direction has it at its lowest place, along -z. Precondition: it has
/// triangles.
TipOfMesh guess_tip(const TriangleSoup& mesh);

}  // namespace hapbench
