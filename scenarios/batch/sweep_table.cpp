#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>

#include <fstream>
#include <functional>
#include <utility>

#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/batch/table_description.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

using Condition = std::function<bool(const SweepRow& row)>;

/// Parses a condition of --where. Throws InputError.
Condition condition_of(const std::string& text, const SweepTable& table) {
  static const std::map<std::string, std::function<bool(double, double)>> kSigns = {
      {"<", std::less<>()},           {">", std::greater<>()},  {"<=", std::less_equal<>()},
      {">=", std::greater_equal<>()}, {"=", std::equal_to<>()}, {"!=", std::not_equal_to<>()}};
  // Split the text into column, operator and value.
  const std::size_t begin = std::min(text.find_first_of("<>=!"), text.size());
  const std::size_t end = std::min(text.find_first_not_of("<>=!", begin), text.size());
  const std::string name = text.substr(0, begin), sign = text.substr(begin, end - begin), value = text.substr(end);
  const auto number = finite_number(value);
  const auto holds = kSigns.find(sign);
  if (holds == kSigns.end() || value.empty() || (!number && sign != "=" && sign != "!=")) {
    fail_in_option(
        "--where",
        fmt::format("got \"{}\"; allowed: a column of sweep.csv, one of < <= > >= = !=, and a number (a text with "
                    "= and !=), as inside_max_m<3e-4 or outcome=completes",
                    text));
  }
  require_valid_option("--where", name, table.columns, "hapbench describe sweep.csv");
  return [=, compare = holds->second, column = table.place(name)](const SweepRow& row) {
    if (!number) return (row[column] == value) == (sign == "=");
    const auto found = finite_number(row[column]);
    return found && compare(*found, *number);
  };
}

}  // namespace

void SweepCounts::add(std::size_t run, const std::string& outcome, bool is_expected) {
  const bool is_failure = outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[outcome];
  ++count.runs;
  count.expected += is_expected;
  failed += is_failure;
  if (is_failure || is_expected) return;
  if (unexpected++ == 0) first_unexpected = run;
}

std::vector<std::string> SweepTable::metrics() const {
  const auto first = columns.begin() + static_cast<std::ptrdiff_t>(place("steps")) + 1;
  return {first,
          std::find_if(first, columns.end() - 1, [](const auto& name) { return name.starts_with(kToleranceOf); })};
}

std::optional<double> SweepTable::number(const SweepRow& row, std::string_view column) const {
  const std::size_t at = place(column);
  return at < row.size() ? finite_number(row[at]) : std::nullopt;
}

SweepTable read_sweep(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table{.file = file,
                   .about = description_of(description_file(file)),
                   .columns = {},
                   .rows = {},
                   .counts = {},
                   .kept = {}};
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  table.columns = csv_cells(line);
  // Check the columns.
  const std::size_t outcome = table.place("outcome");
  if (table.columns[0] != "index" || table.columns.back() != "state_hash" || table.place("expected") != outcome + 1 ||
      table.place("steps") != outcome + 2)
    fail_in_file(file, "is not the table of the sweep that sweep.json describes");
  std::vector<Condition> all;
  for (const std::string& text : conditions) all.push_back(condition_of(text, table));
  // Count all rows, and keep the rows that satisfy the conditions.
  while (std::getline(in, line)) {
    SweepRow row = csv_cells(line);
    const auto run = whole_number(row[0]);
    if (!run || row.size() != table.columns.size())
      fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    const bool is_expected = row[outcome + 1] == "true";
    table.counts.add(*run, row[outcome], is_expected);
    if (!std::ranges::all_of(all, [&row](const Condition& keeps) { return keeps(row); })) continue;
    table.kept.add(*run, row[outcome], is_expected);
    if (table.kept.runs <= SweepTable::kMostRows) table.rows.push_back(std::move(row));
  }
  if (table.kept.runs > SweepTable::kMostRows) table.rows.clear();
  return table;
}

}  // namespace hapbench
