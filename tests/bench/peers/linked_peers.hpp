#pragma once

#include "algorithms/peers/contact_library.hpp"

/// Contact sources that are linked with the benchmark and no run uses.
namespace hapbench::bench {

const HapbenchContactSource& kd_tree();  ///< CGAL, over the vertices of the surface
const HapbenchContactSource& ode();

}  // namespace hapbench::bench
