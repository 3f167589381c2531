#pragma once

#include "tests/bench/peers/contact_library.hpp"

/// Collision libraries that the benchmark asks the questions of our search.
namespace hapbench::bench {

const HapbenchContactSource& bullet();
const HapbenchContactSource& fcl();
const HapbenchContactSource& kd_tree();  ///< CGAL, over the vertices of the surface
const HapbenchContactSource& ode();

}  // namespace hapbench::bench
