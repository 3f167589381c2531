#pragma once

#include <string>
#include <string_view>

#include "scenarios/input/json_file.hpp"

/// Overrides `path=value` of a scenario's fields, given with --set.
namespace hapbench {

/// Returns the dotted path of an override `path=value`.
inline std::string_view overridden_path(std::string_view override) noexcept {
  return override.substr(0, override.find('='));
}

/// Returns the JSON pointer of the field that an override sets.
std::string overridden_pointer(std::string_view override);

/// Returns the JSON value of a text. The text is parsed as JSON, or as a number in a notation that JSON does not allow
/// (".001", "+1"). Any other text becomes a JSON string.
Json override_value(const std::string& text);

/// Applies an override "path=value". If a part of the dotted path follows a list, it is an index of this list. A field
/// that excludes the overridden field is removed. Throws InputError if `text` does not have this form, or if the path
/// has too many parts or an index that the list does not have.
void apply_override(Json& scenario, const std::string& text);

/// Returns true if the override does not change the run, so that the scenario's expectations still apply to it.
bool keeps_run_unchanged(std::string_view override);

/// Relaxes the expectations for a run that an override has changed. Removes the bounds on metrics. Adds the outcomes
/// that are expected without the field "expect" (ExpectFields) to the listed outcomes. All other outcomes, such as
/// no_contact and diverges, stay unexpected unless the scenario lists them.
void relax_expectations(Json& expect);

}  // namespace hapbench
