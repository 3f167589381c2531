#include "scenarios/program/columns.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>

#include "scenarios/input/rounding.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

std::string printed_cell(const Cell& cell, const Shown& shown, const std::optional<double>& tolerance) {
  if (const auto* number = std::get_if<double>(&cell))
    return deserved_on_side(*number, tolerance, shown.digits, shown.rounding);
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return std::to_string(*count);
  if (const auto* yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return "-";
}

constexpr int kMaxVariedDigits = 6;

/// Returns a value of a varied field as text: exactly if the value is a whole number or has at most kMaxVariedDigits
/// significant digits, otherwise rounded to `digits` significant digits.
std::string varied_text(double value, int digits) {
  const bool exact = value == std::trunc(value) || value == rounded_to_digits(value, kMaxVariedDigits);
  return rounded_text(value, exact ? kAllDigits : digits);
}

/// Returns the cells of a varied field as texts, with the smallest number of digits with which different numbers have
/// different texts.
std::vector<std::string> varied_cells(std::span<const Cell> cells, const Shown& shown) {
  constexpr int kMinDigits = 4;
  std::set<double> numbers;
  for (const Cell& cell : cells)
    if (const auto* number = std::get_if<double>(&cell)) numbers.insert(*number);
  for (int digits = kMinDigits;; ++digits) {
    std::vector<std::string> texts;
    std::set<std::string> distinct;
    for (const Cell& cell : cells) {
      const auto* number = std::get_if<double>(&cell);
      texts.push_back(number ? varied_text(*number, digits) : printed_cell(cell, shown, std::nullopt));
      if (number) distinct.insert(texts.back());
    }
    if (digits == kMaxVariedDigits || distinct.size() >= numbers.size()) return texts;
  }
}

}  // namespace

Shown under(std::string heading, int digits, Shown where) {
  where.printed = !heading.empty();
  where.heading = std::move(heading);
  where.digits = digits;
  return where;
}

Shown only_printed(bool wide) {
  return {.csv = false, .json = false, .printed = true, .wide = wide};
}

Shown when(bool has_it, Shown where) {
  return has_it ? std::move(where) : Shown{.csv = false, .json = false};
}

Shown varied(Shown where) {
  where.varied = true;
  return where;
}

Shown rounded(Rounding rounding, Shown where) {
  where.rounding = rounding;
  return where;
}

Cell axis_cell(const std::string& value) {
  const auto number = finite_number(value);
  return number ? Cell(*number) : Cell(value);
}

std::vector<std::string> printed(std::span<const Cell> cells, const Shown& shown,
                                 std::span<const std::optional<double>> tolerances) {
  if (shown.varied) return varied_cells(cells, shown);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < cells.size(); ++i) texts.push_back(printed_cell(cells[i], shown, tolerances[i]));
  return texts;
}

}  // namespace hapbench
