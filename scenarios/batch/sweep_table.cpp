#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "results/summary/outcome.hpp"
#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/batch/row_condition.hpp"
#include "scenarios/batch/shard.hpp"
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

/// Checks the rows of a table one after another, because somebody may have cut or edited the table.
class RowChecker {
 public:
  explicit RowChecker(const SweepTable& table)
      : table_(table), outcome_(table.column_index("outcome")), fields_(values_of_fields(table)) {}

  /// Returns the number of the run of a row. Throws InputError that names the line and the column of a fault.
  std::size_t run_of(const SweepRow& row, const std::string& line) {
    ++line_;
    const auto run = whole_number(row[0]);
    if (!run || row.size() != table_.columns.size())
      fail(fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    if (*run < next_run_)
      fail(fmt::format("got run {} after run {}; allowed: each run once, sorted", *run, next_run_ - 1));
    next_run_ = *run + 1;
    for (std::size_t field = 0; field < fields_.size(); ++field)
      if (!fields_[field].empty() && !fields_[field].contains(row[1 + field]))
        refuse_cell(row, 1 + field, "a value of the sweep");
    if (row[outcome_] != kErrorOutcome && !outcome_named(row[outcome_])) refuse_cell(row, outcome_, "an outcome");
    if (row[outcome_ + 1] != "true" && row[outcome_ + 1] != "false") refuse_cell(row, outcome_ + 1, "true or false");
    for (std::size_t at = outcome_ + 2; at + 1 < row.size(); ++at)
      if (!row[at].empty() && !finite_number(row[at])) refuse_cell(row, at, "a number, or an empty cell");
    return *run;
  }
  [[noreturn]] void fail(const std::string& problem) const { fail_in_line(table_.file, line_, problem); }

 private:
  using Values = std::set<std::string, std::less<>>;

  /// Returns the values of each varied field that sweep.json lists; no values for ranges and for tables of --points.
  static std::vector<Values> values_of_fields(const SweepTable& table) {
    std::vector<Values> fields;
    if (!table.about.contains("vary")) return fields;
    for (const Json& field : table.about.at("vary")) {
      Values& values = fields.emplace_back();
      for (const Json& value : field.value("values", Json::array())) values.insert(value.get<std::string>());
    }
    fields.resize(std::min(fields.size(), table.fields()));
    return fields;
  }
  [[noreturn]] void refuse_cell(const SweepRow& row, std::size_t at, const char* allowed) const {
    fail(fmt::format("{}: got {}; allowed: {} (the file was edited)", table_.columns[at], quoted_token(row[at]),
                     allowed));
  }

  const SweepTable& table_;
  std::size_t outcome_;
  std::vector<Values> fields_;
  std::size_t line_ = 1, next_run_ = 0;
};

/// Calls visit(number of the run, row) for each further line. Throws InputError for a line that is not a row of the
/// table.
template <class Visit>
void for_each_row(std::ifstream& in, const SweepTable& table, const Visit& visit) {
  RowChecker checker(table);
  std::string line;
  while (std::getline(in, line)) {
    SweepRow row = csv_cells(line);
    const std::size_t run = checker.run_of(row, line);
    if (in.eof())
      checker.fail("the line has no line end, so that its last cell may be cut off; allowed: complete lines");
    visit(run, row);
  }
}

/// Returns a warning if the table of a whole sweep has fewer rows than the sweep has runs; else an empty text.
/// `has_row`: for each run, true if the table has its row.
std::string warning_of_missing_rows(const SweepTable& table, std::vector<bool> has_row) {
  if (table.about.value("shard", "") != shard_text({})) return "";
  has_row.resize(table.about.value("runs", has_row.size()));
  const auto missing = std::ranges::find(has_row, false);
  if (missing == has_row.end()) return "";
  return fmt::format("{}: {} of {} rows; the first missing row is of run {}; the file was cut or edited",
                     table.file.string(), table.counts.runs, has_row.size(), missing - has_row.begin());
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
                   .kept = {},
                   .warning = {}};
  std::ifstream in = open_rows(table);
  const RowCondition is_kept = parse_row_conditions(conditions, table.columns);
  const std::size_t outcome = table.column_index("outcome");
  // Count all rows, and keep the rows that satisfy the conditions.
  std::vector<bool> has_row;
  for_each_row(in, table, [&](std::size_t run, SweepRow& row) {
    has_row.resize(std::max(has_row.size(), run + 1));
    has_row[run] = true;
    const bool is_expected = row[outcome + 1] == "true";
    table.counts.add(run, row[outcome], is_expected);
    if (!is_kept(row)) return;
    table.kept.add(run, row[outcome], is_expected);
    if (table.kept.runs <= SweepTable::kMaxRows) table.rows.push_back(std::move(row));
  });
  if (table.kept.runs > SweepTable::kMaxRows) table.rows.clear();
  table.warning = warning_of_missing_rows(table, has_row);
  return table;
}

std::vector<std::string> fields_without_effect(const SweepTable& table) {
  std::vector<std::string> names;
  for (std::size_t field = 1; field <= table.fields(); ++field) {
    // Compare each row with the first row that has the same values of the other fields.
    std::map<SweepRow, SweepRow> results;  // by the values of the other fields
    std::size_t compared = 0;
    bool are_equal = true;
    for (const SweepRow& row : table.rows) {
      if (table.outcome(row) == kErrorOutcome) continue;
      const auto end_of_fields = row.begin() + 1 + static_cast<std::ptrdiff_t>(table.fields());
      SweepRow others(row.begin() + 1, end_of_fields), result(end_of_fields, row.end());
      others[field - 1].clear();
      const auto [first, is_new] = results.try_emplace(std::move(others), result);
      compared += !is_new;
      are_equal = are_equal && first->second == result;
    }
    if (compared > 0 && are_equal) names.push_back(table.columns[field]);
  }
  return names;
}

std::vector<std::size_t> runs_that_meet(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table{.file = file, .about = {}, .columns = {}, .rows = {}, .counts = {}, .kept = {}, .warning = {}};
  std::ifstream in = open_rows(table);
  const RowCondition is_kept = parse_row_conditions(conditions, table.columns);
  std::vector<std::size_t> runs;
  for_each_row(in, table, [&](std::size_t run, const SweepRow& row) {
    if (is_kept(row)) runs.push_back(run);
  });
  return runs;
}

}  // namespace hapbench
