#pragma once

#include "algorithms/rendering_config.hpp"
#include "scenarios/input/fields.hpp"

namespace hapbench {

/// The fields of `rendering` with meaning, unit, range and default. A visitor that reads fills in the stages that the
/// algorithm fixes.
void describe(Fields& f, RenderingConfig& rendering);

}  // namespace hapbench
