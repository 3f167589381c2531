#pragma once

#include <string>

#include "scenarios/run/diagnosed_run.hpp"

/// Returns the advice of the diagnosis rules: what to change in the scenario of a run. The advice depends on the
/// quantities measured in the run. It names only fields that the scenario has, and never recommends the law of the run.
namespace hapbench {

/// The field of the damping ratio as the advice names it.
std::string damping_ratio_field();

/// Returns true if the law of the run pulls the tool into the surface (rule `inward`).
bool pulls_inwards(const DiagnosedRun& run);

/// The advice of other rules for a law that pulls the tool into the surface.
std::string correct_pulling_law();

std::string against_fault(const DiagnosedRun& run);
std::string against_divergence(const DiagnosedRun& run);
std::string against_sinking(const DiagnosedRun& run);
std::string against_loss(const DiagnosedRun& run);
std::string against_standstill(const DiagnosedRun& run);
std::string against_long_steps(const DiagnosedRun& run);
std::string against_unstable_stiffness(const DiagnosedRun& run);
std::string against_unstable_servo(const DiagnosedRun& run);
std::string against_unstable_loop(const DiagnosedRun& run);
std::string against_buzz(const DiagnosedRun& run);
std::string against_pops(const DiagnosedRun& run);
std::string against_shaking(const DiagnosedRun& run);
std::string against_reduction(const DiagnosedRun& run);
std::string against_coarseness(const DiagnosedRun& run);
std::string against_depth(const DiagnosedRun& run);
std::string against_softness(const DiagnosedRun& run);
std::string against_sums(const DiagnosedRun& run);
std::string against_damping(const DiagnosedRun& run);
std::string against_friction(const DiagnosedRun& run);
std::string against_encoder(const DiagnosedRun& run);
std::string against_inward_force(const DiagnosedRun& run);
std::string against_saturation(const DiagnosedRun& run);
std::string against_input_limit(const DiagnosedRun& run);
std::string against_bounces(const DiagnosedRun& run);
std::string against_chatter(const DiagnosedRun& run);
std::string against_energy(const DiagnosedRun& run);
std::string against_reversed_force(const DiagnosedRun& run);
std::string against_drift(const DiagnosedRun& run);

}  // namespace hapbench
