#pragma once

#include <string>
#include <vector>

namespace hapbench {

/// Every name that `hapbench describe` explains.
std::vector<std::string> described_names();

}  // namespace hapbench
