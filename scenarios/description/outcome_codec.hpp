#pragma once

#include <string>
#include <vector>

#include "scenarios/description/codec.hpp"

namespace hapbench {

/// One outcome, or a list of outcomes that are all right: "completes", "leaves_hole", "tool_horizontal", "diverges".
CodecPtr<std::vector<std::string>> outcomes();

}  // namespace hapbench
