#pragma once

#include <string>
#include <vector>

#include "results/observe/metrics.hpp"

namespace hapbench {

/// What to know before the forces of a run are believed, a sentence each: it passed the limit of explicit friction
/// (results/observe/metrics.hpp), or the reduction makes its force jump
/// (results/observe/metrics.hpp).
std::vector<std::string> force_warnings(const Metrics& metrics);

}  // namespace hapbench
