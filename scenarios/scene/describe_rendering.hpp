#pragma once

#include "algorithms/rendering_config.hpp"
#include "scenarios/input/fields.hpp"

namespace hapbench {

/// Describes the fields of `rendering` with meaning, unit, range and default. When a file is read, the stages
/// that the chosen algorithm fixes, such as its depth model, become the defaults.
void describe(Fields& f, RenderingConfig& rendering);

}  // namespace hapbench
