#pragma once

#include <string_view>

#include "scenarios/input/json_file.hpp"

/// Merges the fields of a scenario over the fields of its base scenario.
namespace hapbench {

/// Merges `more` over `base` by the rules of read_scenario_text (scenario_text.hpp).
void merge_fields(Json& base, const Json& more);

/// Removes from `object` the field that excludes `field`; for example, the field "steps" excludes "duration_s". Does
/// nothing if `object` has no field that excludes `field`.
void drop_alternative(Json& object, std::string_view field);

/// Removes the device's field `delay_samples` if the device also has `delay_s`. A result of effective_scenario() has
/// both fields, and its `delay_samples` was computed from `delay_s` and the time step. Called when a scenario that
/// extends this scenario, or an override, changes the time step.
void drop_derived_samples(Json& scenario);

}  // namespace hapbench
