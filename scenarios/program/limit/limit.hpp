#pragma once

#include "scenarios/analysis/stability/field_limit.hpp"

/// What `limit` and other searches share: their options, and how an edge is told.
namespace hapbench {

/// "a:b"; none for an empty text. Throws InputError that names the option.
std::optional<Range> range_of(const char* option, const std::string& text);
/// Adds "metric=most" or "metric=least:most", as given to --bound. Throws InputError.
void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds);
/// The devices of these names and files, each once; a preset's name with [soft] or [stiff] behind it is the preset at
/// that end of what nobody published of it. Throws InputError.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given);

/// The answer in words: the linear edge, or the edge in runs, and what was tried between.
std::string limit_answer(const FieldLimit& found, double resolution);

}  // namespace hapbench
