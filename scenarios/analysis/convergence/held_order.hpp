#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "scenarios/batch/number_with_error.hpp"

/// The order of numbers that is significant at their errors.
namespace hapbench {

/// Places of numbers in the order that their errors leave.
struct HeldOrder {
  /// Each number of a group is less (is_less()) than every number of the groups behind it.
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> unplaced;  ///< numbers that are apart from no other, where others are
};

/// Numbers without a value or an error have no place.
HeldOrder held_order(std::span<const NumberWithError> numbers);

/// The same in a sentence about named numbers: "the order holds: mean < proxy".
std::string held_text(std::span<const NumberWithError> numbers, std::span<const std::string> names);

}  // namespace hapbench
