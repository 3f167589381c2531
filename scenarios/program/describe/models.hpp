#pragma once

#include "scenarios/program/describe/index.hpp"

/// The descriptions of what computes and judges: models, presets, stability, diagnosis.
namespace hapbench {

/// Adds algorithms, depth models, stages and integrators.
void add_models(Index& index);
/// Adds the presets of devices.
void add_presets(Index& index);
/// The classes of motion and the limits of stiffness.
Description describe_stability();
/// The rules of the diagnosis.
Description describe_diagnosis();

}  // namespace hapbench
