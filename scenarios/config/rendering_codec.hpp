#pragma once

#include "scenarios/codec/codec.hpp"
#include "scenarios/config/scenario.hpp"

namespace hapbench {

/// The "rendering" object of a scenario.
CodecPtr<RenderingFields> rendering_codec();

}  // namespace hapbench
