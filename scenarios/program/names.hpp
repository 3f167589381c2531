#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// Throws InputError with the option's name if a name is not valid or is given twice. `shown_by`: command that shows
/// all valid names; see quoted_list().
void require_names(const std::string& option, const std::vector<std::string>& names,
                   const std::vector<std::string>& valid, std::string_view shown_by = {});
/// Returns the names that an option selects, where "all" alone stands for all names. Throws InputError like
/// require_names().
std::vector<std::string> chosen_names(const std::string& option, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all, std::string_view shown_by = {});

/// Returns the algorithms that --algorithms selects. Throws InputError like require_names().
std::vector<std::string> chosen_algorithms(const std::vector<std::string>& given);

/// Returns the requested metric. Without a request, returns the first of kDefaultMetrics that `metrics` has, or the
/// last of kDefaultMetrics if `metrics` has none of them. Throws InputError if the requested metric is not among
/// `metrics`.
std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& requested);

/// Returns the first `max_count` texts; if there are more, adds a text with the number of omitted texts.
std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t max_count);

}  // namespace hapbench
