#include "scenarios/input/nearest_name.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/renamed_names.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

/// Returns the edit distance (optimal string alignment) of two names: the smallest number of edits that convert `a`
/// into `b`. An edit replaces, removes or inserts a letter, or swaps two adjacent letters. Appending the whole part of
/// `b` after an underscore also counts as one edit.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows of the distance matrix. Entry j of row i is the distance from the first i letters of `a` to the first j
  // letters of `b`.
  std::vector<std::size_t> row(b.size() + 1), before(row), row_before_previous(row);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row_before_previous.swap(before);
    before.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, before[j] + 1, row[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], row_before_previous[j - 2] + 1);
    }
  }
  // Allow `a` to lack the ending of `b` after an underscore, at the cost of one edit.
  std::size_t smallest = row.back();
  for (std::size_t j = 1; j < b.size(); ++j)
    if (b[j] == '_') smallest = std::min(smallest, row[j] + 1);
  return smallest;
}

/// Returns the new name of `given` if `given` was renamed and the new name is in `valid`; else an empty text.
std::string_view valid_new_name(std::string_view given, std::span<const std::string> valid) {
  const std::string_view now = new_name_of(given);
  return !now.empty() && std::ranges::find(valid, now) != valid.end() ? now : std::string_view();
}

}  // namespace

std::string nearest_name(std::string_view given, std::span<const std::string> valid) {
  if (const std::string_view now = valid_new_name(given, valid); !now.empty()) return std::string(now);
  const std::string lower = lower_case(given);
  std::string best;
  // The largest accepted distance is a third of the number of letters in `given`, but at least 2. If `given` has at
  // most 4 letters, the largest distance is 1, because so short a name would otherwise match almost any name.
  std::size_t best_distance = std::max<std::size_t>(given.size() > 4 ? 2 : 1, given.size() / 3) + 1;
  for (const std::string& name : valid) {
    // Skip a name that is so much shorter than `given` that it cannot be nearer than the best name. Without this check,
    // edit_distance() would take too long for a `given` of megabytes, which an untrusted file may contain.
    if (given.size() >= name.size() + best_distance) continue;
    const std::string lower_name = lower_case(name);
    const bool contains = given.size() >= 3 && lower_name.find(lower) != std::string::npos;
    const std::size_t distance = contains ? 1 : edit_distance(lower, lower_name);
    if (distance < best_distance) {
      best_distance = distance;
      best = name;
    }
  }
  return best;
}

std::string nearest_name_hint(std::string_view given, std::span<const std::string> valid) {
  if (const std::string_view now = valid_new_name(given, valid); !now.empty())
    return fmt::format("; version 0.4.0 renamed it to \"{}\"", now);
  const std::string name = nearest_name(given, valid);
  return name.empty() ? "" : fmt::format("; nearest valid name: \"{}\"", name);
}

namespace {

std::string refusal_of(std::string_view got, const std::string& name, std::span<const std::string> valid,
                       std::string_view shown_by) {
  return fmt::format("{} \"{}\"{}; allowed: {}", got, name, nearest_name_hint(name, valid),
                     quoted_list(valid, shown_by));
}

}  // namespace

void require_valid_option(const std::string& option, const std::string& name, std::span<const std::string> valid,
                          std::string_view shown_by) {
  if (std::ranges::find(valid, name) != valid.end()) return;
  fail_in_option(option, refusal_of("got", name, valid, shown_by));
}

void require_valid_name(std::string_view got, const std::string& name, std::span<const std::string> valid,
                        std::string_view shown_by) {
  if (std::ranges::find(valid, name) != valid.end()) return;
  throw InputError(refusal_of(got, name, valid, shown_by));
}

std::string quoted_list(std::span<const std::string> names, std::string_view shown_by) {
  if (names.empty()) return "nothing";
  const std::size_t max_shown = shown_by.empty() ? 50 : 8, more = names.size() - std::min(names.size(), max_shown);
  std::string text = fmt::format("\"{}\"", fmt::join(names.first(names.size() - more), "\", \""));
  if (more > 0) text += fmt::format(" and {} more", more);
  return more > 0 && !shown_by.empty() ? text + fmt::format("; run \"{}\" to list them", shown_by) : text;
}

}  // namespace hapbench
