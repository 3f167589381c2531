#pragma once

#include <string_view>

#include "scenarios/input/json_file.hpp"

/// Merges the fields of a scenario over the fields of its base scenario.
namespace hapbench {

/// Merges `more` over `base` by the rules of read_scenario_text (scenario_text.hpp).
void merge_fields(Json& base, const Json& more);

/// Removes from `object` the field that excludes `field`.
void drop_alternative(Json& object, std::string_view field);

/// Removes `delay_samples` of the device if `delay_s` is there too. An effective scenario has both, but the number of
/// samples was computed for a time step that has changed since.
void drop_derived_samples(Json& scenario);

}  // namespace hapbench
