#pragma once

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// Descriptions of models, device presets, stability classes and diagnosis rules.
namespace hapbench {

/// Adds algorithms, depth models, stages and integrators.
void add_models(Index& index, const Layout& layout);
/// Adds the presets of devices.
void add_presets(Index& index, const Layout& layout);
/// Describes the classes of motion and the closed-form stiffness limits.
Description describe_stability(const Layout& layout);
/// Describes the rules of the diagnosis.
Description describe_diagnosis(const Layout& layout);

}  // namespace hapbench
