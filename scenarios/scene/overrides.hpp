#pragma once

#include <string>
#include <string_view>

#include "scenarios/input/json_file.hpp"

/// Overrides of a scenario's fields, path=value, as --set takes them.
namespace hapbench {

/// The dotted path of an override, path=value.
inline std::string_view overridden_path(std::string_view override) noexcept {
  return override.substr(0, override.find('='));
}

/// Sets the field at a dotted path; a number in the path indexes a list. Of two fields that exclude each other the
/// other one is removed, as where a scenario extends another.
void apply_override(Json& scenario, const std::string& text);

/// True when a run with this field overridden is still the run that the scenario's expectations were written for.
bool leaves_run_alone(std::string_view override);

/// Removes the expectations that hold only for the run that the scenario describes: bounds on metrics and the exact
/// outcome. A run that misses its object or diverges stays unexpected unless the scenario expects it.
void expect_less(Json& expect);

}  // namespace hapbench
