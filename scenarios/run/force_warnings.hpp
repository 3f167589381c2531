#pragma once

#include <string>
#include <vector>

#include "results/observe/metrics.hpp"

namespace hapbench {

/// What to know before the forces of a run are believed, a sentence each: it passed the limit of explicit friction
/// (results/observe/explicit_friction.hpp), or the reduction makes its force jump
/// (results/observe/reduction_jumps.hpp).
std::vector<std::string> force_warnings(const Metrics& metrics);

}  // namespace hapbench
