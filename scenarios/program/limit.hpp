#pragma once

#include <map>
#include <optional>
#include <string>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/description/scenario.hpp"

/// Options of `limit` that other searches take, too.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);

/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);

}  // namespace hapbench
