#include "scenarios/analysis/convergence/held_order.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace hapbench {
namespace {

std::string joined(std::span<const std::size_t> places, std::span<const std::string> names, const char* between) {
  std::vector<std::string> found;
  for (const std::size_t i : places) found.push_back(names[i]);
  return fmt::format("{}", fmt::join(found, between));
}

}  // namespace

HeldOrder held_order(std::span<const NumberWithError> numbers) {
  const auto comes_before = [&](std::size_t a, std::size_t b) { return is_less(numbers[a], numbers[b]); };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && numbers[i].error) order.push_back(i);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return *numbers[i].value; });
  HeldOrder held;
  const auto is_alike = [&](std::size_t a) {
    return std::ranges::none_of(order, [&](std::size_t b) { return comes_before(a, b) || comes_before(b, a); });
  };
  std::ranges::copy_if(order, std::back_inserter(held.unplaced), is_alike);
  if (held.unplaced.size() == order.size()) held.unplaced.clear();
  std::erase_if(order, [&](std::size_t a) { return std::ranges::find(held.unplaced, a) != held.unplaced.end(); });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::span left = std::span(order).first(k), right = std::span(order).subspan(k);
    const bool is_cut = std::ranges::all_of(left, [&](std::size_t a) {
      return std::ranges::all_of(right, [&](std::size_t b) { return comes_before(a, b); });
    });
    if (is_cut) held.groups.emplace_back();
    held.groups.back().push_back(order[k]);
  }
  return held;
}

std::string held_text(std::span<const NumberWithError> numbers, std::span<const std::string> names) {
  const auto [groups, unplaced] = held_order(numbers);
  std::vector<std::string> parts;
  std::size_t placed = 0;
  for (const std::vector<std::size_t>& group : groups) {
    parts.push_back(joined(group, names, " ~ "));
    placed += group.size();
  }
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && !numbers[i].error) unknown.push_back(i);
  const char* says = groups.size() == 1                            ? "no significant order: "
                     : groups.size() == placed && unplaced.empty() ? "significant order: "
                                                                   : "partly significant order: ";
  std::string text = placed < 2 ? "nothing to compare" : fmt::format("{}{}", says, fmt::join(parts, " < "));
  if (!unplaced.empty()) text += "; error too large to rank: " + joined(unplaced, names, ", ");
  if (!unknown.empty()) text += "; no error estimate for: " + joined(unknown, names, ", ");
  return text;
}

}  // namespace hapbench
