#include "scenarios/batch/row_condition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

RowCondition parse_row_condition(const std::string& text, const std::vector<std::string>& columns) {
  static const std::map<std::string, std::function<bool(double, double)>> kSigns = {
      {"<", std::less<>()},           {">", std::greater<>()},  {"<=", std::less_equal<>()},
      {">=", std::greater_equal<>()}, {"=", std::equal_to<>()}, {"!=", std::not_equal_to<>()}};
  // The sign begins at the first of the characters < > = ! and includes all of these characters that follow directly.
  // So "a==3" has the sign "==", which is rejected.
  const std::size_t begin = std::min(text.find_first_of("<>=!"), text.size());
  const std::size_t end = std::min(text.find_first_not_of("<>=!", begin), text.size());
  const std::string name = text.substr(0, begin), sign = text.substr(begin, end - begin), value = text.substr(end);
  const auto number = finite_number(value);
  const auto holds = kSigns.find(sign);
  if (holds == kSigns.end() || value.empty() || (!number && sign != "=" && sign != "!=")) {
    fail_in_option(
        "--where",
        fmt::format("got \"{}\"; allowed: a column of sweep.csv, one of < <= > >= = !=, and a number (a text with "
                    "= and !=), such as inside_max_m<3e-4 or outcome=completes",
                    text));
  }
  require_valid_option("--where", name, columns, "hapbench describe sweep.csv");
  const auto column = static_cast<std::size_t>(std::ranges::find(columns, name) - columns.begin());
  return [=, compare = holds->second](const std::vector<std::string>& row) {
    if (!number) return (row[column] == value) == (sign == "=");
    const auto found = finite_number(row[column]);
    return found && compare(*found, *number);
  };
}

RowCondition parse_row_conditions(const std::vector<std::string>& texts, const std::vector<std::string>& columns) {
  std::vector<RowCondition> all;
  for (const std::string& text : texts) all.push_back(parse_row_condition(text, columns));
  return [all = std::move(all)](const std::vector<std::string>& row) {
    return std::ranges::all_of(all, [&row](const RowCondition& is_met) { return is_met(row); });
  };
}

}  // namespace hapbench
