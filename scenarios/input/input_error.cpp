#include "scenarios/input/input_error.hpp"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hapbench {
namespace {

/// Levenshtein distance; names are short, so the quadratic table in one row is enough.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return text;
}

void fail_in_file(const std::filesystem::path& file, const std::string& problem) {
  throw InputError(InputError::Kind::relation, file.string(), problem);
}

void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  throw InputError(InputError::Kind::relation, fmt::format("{}, line {}", file.string(), line), problem);
}

std::string nearest_name(std::string_view given, std::span<const std::string> valid) {
  // A hostile name may be megabytes long; nothing that long is near a name of ours.
  if (given.size() > 200) return "";
  std::string best;
  // A third of the letters may be wrong; in a short name more than one would match anything.
  std::size_t best_distance = std::max<std::size_t>(given.size() > 4 ? 2 : 1, given.size() / 3) + 1;
  for (const std::string& name : valid) {
    const bool contains = given.size() >= 3 && name.find(given) != std::string::npos;
    const std::size_t distance = contains ? 1 : edit_distance(given, name);
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

void require_valid_name(std::string_view got, const std::string& name, std::span<const std::string> valid) {
  if (std::find(valid.begin(), valid.end(), name) != valid.end()) return;
  throw InputError(
      fmt::format("{} \"{}\"; allowed: {}{}", got, name, quoted_list(valid), nearest_name_hint(name, valid)));
}

std::string quoted_list(std::span<const std::string> names) {
  constexpr std::size_t kMostNames = 50;  // more than that nobody reads
  if (names.empty()) return "nothing";
  const std::size_t more = names.size() - std::min(names.size(), kMostNames);
  return fmt::format("\"{}\"{}", fmt::join(names.first(names.size() - more), "\", \""),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

}  // namespace hapbench
