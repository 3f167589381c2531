#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// Throws InputError about an option unless each of its names is among the valid ones and given once. `shown_by`: a
/// command that shows the valid ones, see quoted_list.
void require_names(const std::string& option, const std::vector<std::string>& names,
                   const std::vector<std::string>& valid, std::string_view shown_by = {});
/// Checks the same way and returns the names, where "all" alone stands for all of them.
std::vector<std::string> chosen_names(const std::string& option, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all, std::string_view shown_by = {});

/// The algorithms of --algorithms.
std::vector<std::string> chosen_algorithms(const std::vector<std::string>& given);

/// The metric to show: the one asked for, else the first of kDefaultMetrics. Throws InputError when it is not there.
std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for);

/// The first texts, and behind them how many more there are.
std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t most);

}  // namespace hapbench
