#pragma once

#include <vector>

#include "scenarios/thesis_claims/choices.hpp"

/// The format of results/reference/choices.json.
namespace hapbench {

/// The choices of a file. Throws InputError with JSON pointer, the value given and what is allowed.
std::vector<OpenChoice> read_choices(const Json& json);

/// The JSON Schema (draft 7) that results/reference/choices.schema.json holds.
Json choices_schema();

}  // namespace hapbench
