#include "scenarios/input/nearest_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

/// Number of letters to replace, remove, insert or swap with a neighbour to turn `a` into `b`. If that is less, one
/// more than the number for a part of `b` that ends before an underscore.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1), before(row), before_that(row);  // for the first letters of `a`
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_that.swap(before);
    before.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, before[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before_that[j - 2] + 1);
    }
  }
  std::size_t least = row.back();
  for (std::size_t j = 1; j < b.size(); ++j)
    if (b[j] == '_') least = std::min(least, row[j] + 1);
  return least;
}

}  // namespace

std::string nearest_name(std::string_view given, std::span<const std::string> valid) {
  const std::string lower = lower_case(given);
  std::string best;
  // A third of the letters may be wrong, but only one in a short name, which would otherwise match anything.
  std::size_t best_distance = std::max<std::size_t>(given.size() > 4 ? 2 : 1, given.size() / 3) + 1;
  for (const std::string& name : valid) {
    // Letters to remove alone are too many. A hostile name may be megabytes long.
    if (given.size() >= name.size() + best_distance) continue;
    const bool contains = given.size() >= 3 && name.find(given) != std::string::npos;
    const std::size_t distance = contains ? 1 : edit_distance(lower, lower_case(name));
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

std::string nearest_name_hint(std::string_view given, std::span<const std::string> valid) {
  const std::string name = nearest_name(given, valid);
  return name.empty() ? "" : fmt::format("; nearest valid name: \"{}\"", name);
}

void require_valid_name(std::string_view got, const std::string& name, std::span<const std::string> valid,
                        std::string_view shown_by) {
  if (std::find(valid.begin(), valid.end(), name) != valid.end()) return;
  throw InputError(
      fmt::format("{} \"{}\"{}; allowed: {}", got, name, nearest_name_hint(name, valid), quoted_list(valid, shown_by)));
}

std::string quoted_list(std::span<const std::string> names, std::string_view shown_by) {
  if (names.empty()) return "nothing";
  const std::size_t most = shown_by.empty() ? 50 : 8, more = names.size() - std::min(names.size(), most);
  std::string text = fmt::format("\"{}\"", fmt::join(names.first(names.size() - more), "\", \""));
  if (more > 0) text += fmt::format(" and {} more", more);
  return more > 0 && !shown_by.empty() ? text + fmt::format("; run \"{}\" to list them", shown_by) : text;
}

}  // namespace hapbench
