#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct Sign {
  std::string_view text;
  bool (*holds)(double a, double b);
};

/// Longer ones first.
constexpr Sign kSigns[] = {
    {"<=", [](double a, double b) { return a <= b; }}, {">=", [](double a, double b) { return a >= b; }},
    {"!=", [](double a, double b) { return a != b; }}, {"<", [](double a, double b) { return a < b; }},
    {">", [](double a, double b) { return a > b; }},   {"=", [](double a, double b) { return a == b; }}};

/// A condition on the cells of a row.
class Condition {
 public:
  Condition(const std::string& text, const std::vector<std::string>& columns) {
    const std::size_t end = std::min(text.find_first_of("<>=!"), text.size());
    const std::string rest = text.substr(end), name = text.substr(0, end);
    sign_ = std::find_if(std::begin(kSigns), std::end(kSigns), [&](const Sign& s) { return rest.starts_with(s.text); });
    if (sign_ != std::end(kSigns)) value_ = rest.substr(sign_->text.size());
    number_ = finite_number(value_);
    const bool is_equality = sign_ != std::end(kSigns) && (sign_->text == "=" || sign_->text == "!=");
    if (value_.empty() || (!number_ && !is_equality)) {
      throw InputError(fmt::format(
          "--where: got \"{}\"; allowed: a column of sweep.csv, one of < <= > >= = !=, and a number (a text with = and !=), "
          "as inside_max_m<3e-4 or outcome=completes",
          text));
    }
    require_valid_name("--where: got", name, columns);
    column_ = static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
  }

  bool holds(const std::vector<std::string>& cells) const {
    if (!number_) return (cells[column_] == value_) == (sign_->text == "=");
    const auto number = finite_number(cells[column_]);
    return number && sign_->holds(*number, *number_);
  }

 private:
  std::size_t column_ = 0;
  const Sign* sign_ = nullptr;
  std::string value_;
  std::optional<double> number_;
};

/// The axis that sweep.json describes.
Axis axis_of(const Json& json) {
  Axis axis{.path = json.at("path")};
  if (json.contains("values")) {
    axis.values = json.at("values").get<std::vector<std::string>>();
  } else if (json.contains("range")) {
    axis.range = Range{json.at("range").at(0), json.at("range").at(1), json.at("scale") == "log"};
    axis.steps = json.value("count", std::size_t{0});
  }
  return axis;
}

/// The table without its rows.
SweepTable described_table(const fs::path& file) {
  const fs::path about = fs::path(file).replace_extension(".json");
  try {
    const Json json = parse_json(read_text_file(about, kLargestJsonFile));
    SweepTable table;
    table.file = file;
    table.definition = json.at("definition");
    for (const Json& axis : json.at("vary")) table.axes.push_back(axis_of(axis));
    table.sampled = json.contains("sample");
    table.cases = json.at("runs");
    return table;
  } catch (const Json::exception&) {
    fail_in_file(about, "is not the description of a sweep");
  } catch (const InputError& error) {
    rethrow_with_file(error, about);
  }
}

/// Whether the columns are those of a sweep of these fields.
bool has_columns_of_sweep(const SweepTable& table) {
  const std::vector<std::string> first = leading_columns(table.axes);
  return table.columns.size() > first.size() && table.columns.back() == "state_hash" &&
         std::equal(first.begin(), first.end(), table.columns.begin());
}

}  // namespace

std::vector<std::string> leading_columns(const std::vector<Axis>& axes) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : axes) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  return columns;
}

void SweepCounts::add(std::size_t run, const std::string& outcome, bool is_expected) {
  const bool is_failure = outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[outcome];
  ++count.runs;
  if (is_expected) ++count.expected;
  if (is_failure) ++failed;
  if (is_failure || is_expected) return;
  ++unexpected;
  if (!first_unexpected) first_unexpected = run;
}

std::vector<std::string> SweepTable::metrics() const {
  const auto first = columns.begin() + static_cast<std::ptrdiff_t>(outcome_place()) + 3;
  return {first,
          std::find_if(first, columns.end() - 1, [](const auto& name) { return name.starts_with(kToleranceOf); })};
}

std::optional<double> SweepTable::number(const SweepRow& row, std::string_view column) const {
  const auto place = static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
  return place < row.size() ? finite_number(row[place]) : std::nullopt;
}

std::optional<double> SweepTable::tolerance(const SweepRow& row, std::string_view metric) const {
  return number(row, std::string(kToleranceOf) + std::string(metric));
}

SweepTable read_sweep(const fs::path& file, const std::vector<std::string>& conditions) {
  SweepTable table = described_table(file);
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  table.columns = csv_cells(line);
  if (!has_columns_of_sweep(table)) fail_in_file(file, "is not the table of the sweep that sweep.json describes");
  std::vector<Condition> all;
  for (const std::string& text : conditions) all.emplace_back(text, table.columns);
  while (std::getline(in, line)) {
    SweepRow row = csv_cells(line);
    const auto run = whole_number(row[0]);
    if (!run || row.size() != table.columns.size())
      fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    const std::string& outcome = table.outcome(row);
    const bool is_expected = row[table.outcome_place() + 1] == "true";
    table.counts.add(*run, outcome, is_expected);
    if (!std::ranges::all_of(all, [&row](const Condition& c) { return c.holds(row); })) continue;
    table.kept.add(*run, outcome, is_expected);
    if (table.kept.runs <= SweepTable::kMostRows) table.rows.push_back(std::move(row));
  }
  if (table.kept.runs > SweepTable::kMostRows) table.rows.clear();
  return table;
}

}  // namespace hapbench
