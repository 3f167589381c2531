#pragma once

#include <span>
#include <string>
#include <string_view>

/// Messages about a name that is none of the valid ones.
namespace hapbench {

/// Returns the valid name nearest to `given` in edit distance, or an empty text if no name is near enough to suggest. The
/// new name of a renamed name (renamed_names.hpp) is the nearest. Case does not matter, and an ending after an
/// underscore, such as a unit, may be missing.
std::string nearest_name(std::string_view given, std::span<const std::string> valid);

/// Returns `; nearest valid name: "x"`, or `; version 0.4.0 renamed it to "x"`, or an empty text.
std::string nearest_name_hint(std::string_view given, std::span<const std::string> valid);

/// Throws an InputError, `got` before the name, when the name is not among the valid ones. `shown_by`: see below.
void require_valid_name(std::string_view got, const std::string& name, std::span<const std::string> valid,
                        std::string_view shown_by = {});

/// "a", "b", "c"; of more than 50 only how many more there are, of more than 8 where the command `shown_by` shows them.
std::string quoted_list(std::span<const std::string> names, std::string_view shown_by = {});

}  // namespace hapbench
