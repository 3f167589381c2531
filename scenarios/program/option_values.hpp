#pragma once

#include <map>
#include <optional>
#include <string>

#include "scenarios/analysis/stability/field_limit.hpp"

/// Ranges, bounds and numbers as words of options have them.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);
/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);
/// The number that an option was given. Throws InputError unless it is one from `least` to `most`.
double number_between(const char* option, const std::string& text, double least, double most);

}  // namespace hapbench
