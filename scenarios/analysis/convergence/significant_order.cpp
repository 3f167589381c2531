#include "scenarios/analysis/convergence/significant_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace hapbench {
namespace {

/// Returns the names at the given indices, joined by `between`.
std::string joined(std::span<const std::size_t> positions, std::span<const std::string> names, const char* between) {
  std::vector<std::string> found;
  for (const std::size_t i : positions) found.push_back(names[i]);
  return fmt::format("{}", fmt::join(found, between));
}

/// Returns the groups of an order, such as "mean ~ shaped_stiffness < proxy"; "nothing to compare" for fewer than two
/// numbers.
std::string groups_text(const std::vector<std::vector<std::size_t>>& groups, std::span<const std::string> names,
                        const char* prefix = "") {
  std::vector<std::string> parts;
  std::size_t grouped = 0;
  for (const std::vector<std::size_t>& group : groups) {
    parts.push_back(joined(group, names, " ~ "));
    grouped += group.size();
  }
  return grouped < 2 ? "nothing to compare" : fmt::format("{}{}", prefix, fmt::join(parts, " < "));
}

bool is_alone_in_each(const std::vector<std::vector<std::size_t>>& groups) {
  return std::ranges::all_of(groups, [](const auto& group) { return group.size() == 1; });
}

/// Returns the end of a sentence that names the numbers whose error is too large to rank them; empty if `numbers` is
/// empty.
std::string indistinguishable_text(std::span<const std::size_t> numbers, std::span<const std::string> names) {
  return numbers.empty() ? "" : "; error too large to rank: " + joined(numbers, names, ", ");
}

}  // namespace

SignificantOrder significant_order(std::span<const NumberWithError> numbers) {
  // Sort the numbers that have a value and an error.
  const auto comes_before = [&](std::size_t a, std::size_t b) { return is_less(numbers[a], numbers[b]); };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && numbers[i].error) order.push_back(i);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return *numbers[i].value; });
  // Separate the numbers that do not differ significantly from any other number.
  SignificantOrder order_found;
  const auto is_indistinguishable = [&](std::size_t a) {
    return std::ranges::none_of(order, [&](std::size_t b) { return comes_before(a, b) || comes_before(b, a); });
  };
  std::ranges::copy_if(order, std::back_inserter(order_found.indistinguishable), is_indistinguishable);
  if (order_found.indistinguishable.size() == order.size()) order_found.indistinguishable.clear();
  std::erase_if(order, [&](std::size_t a) {
    return std::ranges::find(order_found.indistinguishable, a) != order_found.indistinguishable.end();
  });
  // Start a new group wherever all numbers on the left are significantly smaller than all numbers on the right.
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::span left = std::span(order).first(k), right = std::span(order).subspan(k);
    const bool is_cut = std::ranges::all_of(left, [&](std::size_t a) {
      return std::ranges::all_of(right, [&](std::size_t b) { return comes_before(a, b); });
    });
    if (is_cut) order_found.groups.emplace_back();
    order_found.groups.back().push_back(order[k]);
  }
  return order_found;
}

std::string order_text(std::span<const NumberWithError> numbers, std::span<const std::string> names) {
  const SignificantOrder order = significant_order(numbers);
  return groups_text(order.groups, names) + indistinguishable_text(order.indistinguishable, names);
}

std::string significant_order_text(std::span<const NumberWithError> numbers, std::span<const std::string> names) {
  const auto [groups, indistinguishable] = significant_order(numbers);
  std::vector<std::size_t> without_error;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && !numbers[i].error) without_error.push_back(i);
  const char* prefix = groups.size() == 1                                      ? "no significant order: "
                       : is_alone_in_each(groups) && indistinguishable.empty() ? "significant order: "
                                                                               : "partly significant order: ";
  std::string text = groups_text(groups, names, prefix) + indistinguishable_text(indistinguishable, names);
  if (!without_error.empty()) text += "; no error estimate for: " + joined(without_error, names, ", ");
  return text;
}

}  // namespace hapbench
