#pragma once

#include <map>
#include <optional>
#include <string>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/studies/stability/field_limit.hpp"

/// Options of `limit` that other searches take, too, and the words for what they find.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);

/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);

/// The number that an option was given. Throws InputError unless it is one from `least` to `most`.
double number_between(const char* option, const std::string& text, double least, double most);
/// The number given to --vibration [m/s]. Throws InputError.
double vibration_of(const std::string& text);
/// The number given to --resolution. Throws InputError.
double resolution_of(const std::string& text);

/// Names what lies beyond a limit: a class of motion or "end of the range"; without a limit, the class at the range's
/// low end.
std::string beyond_text(const FieldLimit& limit);
/// The same of the other end of the interval of stable values.
std::string other_beyond_text(const FieldLimit& limit);
/// "none of 17 values tried is stable: 12 went_through, 5 vibrating".
std::string none_text(const FieldLimit& limit);

}  // namespace hapbench
