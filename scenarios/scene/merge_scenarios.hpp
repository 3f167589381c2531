#pragma once

#include <string_view>

#include "scenarios/input/json_file.hpp"

/// Merges the fields of a scenario over the fields of its base scenario.
namespace hapbench {

/// Merges `more` over `base` by the rules of read_scenario_text (scenario_text.hpp).
void merge_fields(Json& base, const Json& more);

/// Removes from `object` the field that excludes `field`, such as "duration_s" for "steps". Does nothing if there is no
/// such field.
void drop_alternative(Json& object, std::string_view field);

/// Removes the device's field `delay_samples` if the device also has `delay_s`. An effective scenario has both fields.
/// Its `delay_samples` was computed for its time step, and an extending scenario or an override may change the time
/// step.
void drop_derived_samples(Json& scenario);

}  // namespace hapbench
