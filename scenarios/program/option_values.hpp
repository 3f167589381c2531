#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Parses ranges, bounds and numbers from values of options.
namespace hapbench {

/// Converts the value of an option, "a:b" with numbers a < b, to a range. Returns nullopt for an empty text. Throws
/// InputError with the option's name for every other text.
std::optional<Range> parse_range(const char* option, const std::string& text);
/// Adds the bound of a --bound value, "metric=max" or "metric=min:max", to `bounds`. Throws InputError for an unknown
/// metric and for a value of any other form.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);
/// Throws InputError if runs of none of the scenes have a value of a bounded metric, so that no run can meet the bound.
/// Precondition: there is a scene.
void require_bounded_metrics(const std::map<std::string, MetricBound>& bounds,
                             const std::vector<LoadedScenario>& scenes);
/// Returns the number in the text. Throws InputError with the option's name if the text is not a number from `min` to
/// `max`.
double parse_bounded_number(const char* option, const std::string& text, double min, double max);

}  // namespace hapbench
