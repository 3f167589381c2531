#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>

#include <fstream>
#include <utility>

#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/batch/row_condition.hpp"
#include "scenarios/batch/table_description.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Opens a sweep's table and reads the names of its columns into `table`. Throws InputError if the file is not the
/// table of a sweep.
std::ifstream open_rows(SweepTable& table) {
  std::ifstream in(table.file);
  std::string line;
  std::getline(in, line);
  table.columns = csv_cells(line);
  const std::size_t outcome = table.column_index("outcome");
  if (table.columns[0] != "index" || table.columns.back() != "state_hash" ||
      table.column_index("expected") != outcome + 1 || table.column_index("steps") != outcome + 2)
    fail_in_file(table.file, "is not the table of the sweep that sweep.json describes");
  return in;
}

/// Calls visit(number of the run, row) for each further line. Throws InputError for a line that is not a row of the
/// table.
template <class Visit>
void for_each_row(std::ifstream& in, const SweepTable& table, const Visit& visit) {
  std::string line;
  while (std::getline(in, line)) {
    SweepRow row = csv_cells(line);
    const auto run = whole_number(row[0]);
    if (!run || row.size() != table.columns.size())
      fail_in_file(table.file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    visit(*run, row);
  }
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
  unexpected[outcome].push_back(run);
}

std::vector<std::string> SweepTable::metrics() const {
  // Tables of earlier versions have no column kEndedAt.
  auto first = columns.begin() + static_cast<std::ptrdiff_t>(column_index("steps")) + 1;
  first += *first == kEndedAt;
  return {first,
          std::find_if(first, columns.end() - 1, [](const auto& name) { return name.starts_with(kToleranceOf); })};
}

std::optional<double> SweepTable::number(const SweepRow& row, std::string_view column) const {
  const std::size_t at = column_index(column);
  return at < row.size() ? finite_number(row[at]) : std::nullopt;
}

SweepTable read_sweep(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table{.file = file,
                   .about = description_of(description_file(file)),
                   .columns = {},
                   .rows = {},
                   .counts = {},
                   .kept = {}};
  std::ifstream in = open_rows(table);
  const RowCondition is_kept = parse_row_conditions(conditions, table.columns);
  const std::size_t outcome = table.column_index("outcome");
  // Count all rows, and keep the rows that satisfy the conditions.
  for_each_row(in, table, [&](std::size_t run, SweepRow& row) {
    const bool is_expected = row[outcome + 1] == "true";
    table.counts.add(run, row[outcome], is_expected);
    if (!is_kept(row)) return;
    table.kept.add(run, row[outcome], is_expected);
    if (table.kept.runs <= SweepTable::kMaxRows) table.rows.push_back(std::move(row));
  });
  if (table.kept.runs > SweepTable::kMaxRows) table.rows.clear();
  return table;
}

std::vector<std::size_t> runs_that_meet(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table{.file = file, .about = {}, .columns = {}, .rows = {}, .counts = {}, .kept = {}};
  std::ifstream in = open_rows(table);
  const RowCondition is_kept = parse_row_conditions(conditions, table.columns);
  std::vector<std::size_t> runs;
  for_each_row(in, table, [&](std::size_t run, const SweepRow& row) {
    if (is_kept(row)) runs.push_back(run);
  });
  return runs;
}

}  // namespace hapbench
