#pragma once

#include "scenarios/description/codec.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The "rendering" object of a scenario.
CodecPtr<RenderingFields> rendering_codec();

}  // namespace hapbench
