#pragma once

#include <string_view>

#include "scenarios/input/json_file.hpp"

/// How the fields of one scenario are merged over those of another.
namespace hapbench {

/// Merges the fields of `more` over those of `base`: objects field by field, but an object of another "type" replaces
/// the object of `base`, as does every other value. Removes from `base` the fields that exclude fields of `more`.
void merge_fields(Json& base, const Json& more);

/// Takes out of `object` the field that excludes the one of this name.
void drop_alternative(Json& object, std::string_view field);

/// Removes the delay of the device in samples where the scenario has it in seconds too, as effective scenarios do: the
/// samples are those of a time step that is no longer the scenario's.
void drop_derived_samples(Json& scenario);

}  // namespace hapbench
