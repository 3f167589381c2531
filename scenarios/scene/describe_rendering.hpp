#pragma once

#include "algorithms/rendering_config.hpp"
#include "scenarios/input/fields.hpp"

namespace hapbench {

/// Describes the fields of `rendering` with meaning, unit, range and default. When a file is read, a stage that the
/// chosen algorithm prescribes, such as its depth model, becomes the default.
void describe(Fields& f, RenderingConfig& rendering);

}  // namespace hapbench
