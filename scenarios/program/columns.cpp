#include "scenarios/program/columns.hpp"

#include <variant>

#include "scenarios/program/digits.hpp"

namespace hapbench {

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

std::string printed(const Cell& cell, const Shown& shown, const std::optional<double>& tolerance) {
  if (const auto* number = std::get_if<double>(&cell)) return deserved(*number, tolerance, shown.digits);
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return std::to_string(*count);
  if (const auto* yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return "-";
}

}  // namespace hapbench
