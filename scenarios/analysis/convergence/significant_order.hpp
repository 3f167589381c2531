#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/number_with_error.hpp"

/// Orders numbers with errors: finds which numbers are significantly smaller than other numbers.
namespace hapbench {

/// An order of groups of numbers, given as indices of the numbers.
struct SignificantOrder {
  /// Groups in increasing order: each number is significantly smaller (is_less()) than every number of later groups.
  std::vector<std::vector<std::size_t>> groups;
  /// Indices of the numbers that do not differ significantly from any other number.
  std::vector<std::size_t> indistinguishable;
};

/// Returns the significant order of numbers. Omits numbers without a value or an error. `indistinguishable` is empty if
/// no two numbers differ significantly; then all numbers are in one group.
SignificantOrder significant_order(std::span<const NumberWithError> numbers);

/// Returns the text of significant_order() for named numbers, such as "mean ~ shaped_stiffness < proxy".
std::string order_text(std::span<const NumberWithError> numbers, std::span<const std::string> names);

/// Returns significant_order() as a sentence about named numbers, such as "significant order: mean < proxy".
std::string significant_order_text(std::span<const NumberWithError> numbers, std::span<const std::string> names);

}  // namespace hapbench
