#pragma once

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// The descriptions of what computes and judges: models, presets, stability, diagnosis.
namespace hapbench {

/// Adds algorithms, depth models, stages and integrators.
void add_models(Index& index, const Layout& layout);
/// Adds the presets of devices.
void add_presets(Index& index, const Layout& layout);
/// The classes of motion and the limits of stiffness.
Description describe_stability(const Layout& layout);
/// The rules of the diagnosis.
Description describe_diagnosis(const Layout& layout);

}  // namespace hapbench
