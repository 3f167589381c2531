#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// Throws InputError unless each name is among the valid ones and given once; `got` stands before the name in its
/// message, as in "--only: got". `shown_by`: a command that shows the valid ones, see quoted_list.
void require_names(std::string_view got, const std::vector<std::string>& names, const std::vector<std::string>& valid,
                   std::string_view shown_by = {});
/// Checks the same way and returns the names, where "all" alone stands for all of them.
std::vector<std::string> chosen_names(std::string_view got, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all, std::string_view shown_by = {});

/// The algorithms of --algorithms.
std::vector<std::string> chosen_algorithms(const std::vector<std::string>& given);

/// The metric to show: the one asked for, else the first of kDefaultMetrics. Throws InputError when it is not there.
std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for);

/// The first texts, and behind them how many more there are.
std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t most);

}  // namespace hapbench
