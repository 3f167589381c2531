#pragma once

#include <span>
#include <string>
#include <string_view>

/// Error messages for unknown names.
namespace hapbench {

/// Returns the valid name with the smallest edit distance to `given`, or an empty text if no name is near enough to be
/// suggested. If `given` is a name that was renamed (renamed_names.hpp), its new name counts as the nearest. The
/// comparison ignores case. The part of a valid name after an underscore, such as a unit, may be missing in `given`. A
/// valid name that contains `given` has a distance of 1 if `given` has at least 3 letters.
std::string nearest_name(std::string_view given, std::span<const std::string> valid);

/// Returns `; nearest valid name: "x"`. If `given` was renamed to a valid name x, returns
/// `; version 0.4.0 renamed it to "x"`. If no name is near enough, returns an empty text.
std::string nearest_name_hint(std::string_view given, std::span<const std::string> valid);

/// Throws an InputError about `option` if its value `name` is not one of the valid names. `shown_by`: command that
/// shows all valid names; see quoted_list().
void require_valid_option(const std::string& option, const std::string& name, std::span<const std::string> valid,
                          std::string_view shown_by = {});

/// Throws an InputError if `name` is not one of the valid names. `got` is the beginning of the message, before
/// the name. `shown_by`: command that shows all valid names; see quoted_list().
void require_valid_name(std::string_view got, const std::string& name, std::span<const std::string> valid,
                        std::string_view shown_by = {});

/// Returns the names as `"a", "b", "c"`. A list of more than 50 names is truncated and ends with the number of
/// omitted names. If a command `shown_by` is given, a list of more than 8 names is truncated and ends with that
/// command, which shows all names.
std::string quoted_list(std::span<const std::string> names, std::string_view shown_by = {});

}  // namespace hapbench
