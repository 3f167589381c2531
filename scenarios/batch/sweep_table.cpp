#include "scenarios/batch/sweep_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "results/summary/outcome_names.hpp"
#include "scenarios/batch/table_file.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// The place of `outcome`, behind the number of the run and the varied fields; `expected`, `steps` and the metrics
/// follow.
std::size_t outcome_at(const SweepPlan& plan) {
  return 1 + plan.cases.axes().size();
}

std::size_t column_count(const SweepPlan& plan) {
  return outcome_at(plan) + 3 + plan.metrics.size() + plan.bounded.size() + 1;
}

/// A number: a count if it is whole, so that it is printed as it is in the table; null for other texts.
Json number_json(const std::string& cell) {
  if (const auto count = whole_number(cell)) return *count;
  if (const auto number = finite_number(cell)) return *number;
  return nullptr;
}

/// A text, the value of a varied field or a truth, by its looks.
Json text_json(const std::string& text) {
  if (text.starts_with('{') || text.starts_with('[')) return parse_json(text);
  if (text == "true" || text == "false") return text == "true";
  const Json number = number_json(text);
  return number.is_null() ? Json(text) : number;
}

/// The first cells of a run's line.
std::vector<std::string> leading_cells(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = plan.cases.values(run);
  cells.insert(cells.begin(), std::to_string(run));
  return cells;
}

std::string line_of(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) line += csv_cell(cell) + ",";
  line.pop_back();
  return line;
}

}  // namespace

std::optional<double> SweepRow::number(const SweepPlan& plan, std::string_view metric) const {
  const auto place = std::ranges::find(plan.metrics, metric) - plan.metrics.begin();
  return finite_number(cells[outcome_at(plan) + 3 + static_cast<std::size_t>(place)]);
}

std::optional<double> SweepRow::tolerance(const SweepPlan& plan, std::string_view metric) const {
  const auto name = std::ranges::find(plan.bounded, metric);
  if (name == plan.bounded.end()) return std::nullopt;
  const auto place = plan.metrics.size() + static_cast<std::size_t>(name - plan.bounded.begin());
  return finite_number(cells[outcome_at(plan) + 3 + place]);
}

std::vector<std::string> sweep_columns(const SweepPlan& plan) {
  std::vector<std::string> columns = {"index"};
  for (const Axis& axis : plan.cases.axes()) columns.push_back(axis.path);
  columns.insert(columns.end(), {"outcome", "expected", "steps"});
  columns.insert(columns.end(), plan.metrics.begin(), plan.metrics.end());
  for (const std::string& metric : plan.bounded) columns.push_back(std::string(kToleranceOf) + metric);
  columns.emplace_back("state_hash");
  return columns;
}

std::string finished_row(const SweepPlan& plan, std::size_t run, const RunSummary& summary) {
  std::vector<std::string> cells = leading_cells(plan, run);
  cells.insert(cells.end(), {std::string(outcome_name(summary.result.outcome)), summary.expected ? "true" : "false",
                             std::to_string(summary.result.rows)});
  const MetricList metrics = metric_list(summary);
  auto next = metrics.begin();  // the columns are in the same order, but some runs have more metrics than others
  for (const std::string& name : plan.metrics) {
    const bool is_it = next != metrics.end() && next->name == name;
    cells.push_back(is_it ? cell_text(next->value) : "");
    if (is_it) ++next;
  }
  if (next != metrics.end()) {
    throw InputError(
        fmt::format("has the metric {}, for which no run that was checked before the first one has a column; allowed: "
                    "sweeps whose first runs record what the others record",
                    next->name));
  }
  for (const std::string& name : plan.bounded) {
    const Metric* metric = find_metric(metrics, name);
    const auto tolerance = metric != nullptr ? metric->tolerance() : std::nullopt;
    cells.push_back(tolerance ? cell_text(*tolerance) : "");
  }
  cells.push_back(hash_text(summary.metrics.state_hash));
  return line_of(cells);
}

std::string error_row(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> cells = leading_cells(plan, run);
  cells.insert(cells.end(), {std::string(kErrorOutcome), "false"});
  cells.resize(column_count(plan));
  return line_of(cells);
}

SweepRow sweep_row(const SweepPlan& plan, std::string_view line) {
  std::vector<std::string> cells = csv_cells(line);
  const std::size_t outcome = outcome_at(plan);
  const auto run = whole_number(cells[0]);
  if (!run || cells.size() != column_count(plan))
    throw InputError(fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
  return {.run = *run,
          .values = {cells.begin() + 1, cells.begin() + static_cast<std::ptrdiff_t>(outcome)},
          .outcome = cells[outcome],
          .expected = cells[outcome + 1] == "true",
          .state_hash = cells.back(),
          .cells = cells};
}

Json row_json(const SweepPlan& plan, const SweepRow& row) {
  const std::vector<std::string> names = sweep_columns(plan);
  const std::size_t steps = outcome_at(plan) + 2;
  Json json;
  for (std::size_t c = 0; c < names.size(); ++c)
    json[names[c]] = c < steps ? text_json(row.cells[c]) : number_json(row.cells[c]);
  json[names.back()] = row.state_hash.empty() ? Json(nullptr) : Json(row.state_hash);
  return json;
}

void SweepCounts::add(const SweepRow& row) {
  const bool is_failure = row.outcome == kErrorOutcome;
  ++runs;
  Count& count = outcomes[row.outcome];
  ++count.runs;
  if (row.expected) ++count.expected;
  if (is_failure) ++failed;
  if (is_failure || row.expected) return;
  ++unexpected;
  if (!first_unexpected) first_unexpected = row.run;
}

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

/// The cases without their scenes, which only those that run need.
Cases cases_of(const Json& json) {
  std::vector<Axis> axes;
  for (const Json& axis : json.at("vary")) axes.push_back(axis_of(axis));
  if (!json.contains("sample")) return {{}, json.at("set"), std::move(axes)};
  const Json& sample = json.at("sample");
  const std::size_t count = std::min(sample.at("runs").get<std::size_t>(), kMostRuns);
  if (sample.at("method") == sampling_name(SamplingMethod::points)) {
    const std::size_t fields = axes.size();
    return {{}, json.at("set"), PointTable{std::move(axes), std::vector(fields, std::vector<std::uint32_t>(count))}};
  }
  return {{},
          json.at("set"),
          std::move(axes),
          parse_sampling(fmt::format("{}:{}", sample.at("method").get<std::string>(), count), sample.at("seed"))};
}

SweepPlan plan_of(const fs::path& file) {
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    return {.cases = cases_of(json),
            .warnings = {},
            .metrics = {},
            .bounded = {},
            .content = {},
            .definition = json.at("definition")};
  } catch (const Json::exception&) {
    fail_in_file(file, "is not the description of a sweep");
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

}  // namespace

SweepOnRecord read_sweep(const fs::path& folder, const std::vector<std::string>& conditions) {
  SweepOnRecord found{plan_of(folder / "sweep.json"), {}};
  const fs::path file = found.report.table = folder / "sweep.csv";
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> columns = csv_cells(line);
  for (std::size_t c = outcome_at(found.plan) + 3; c + 1 < columns.size(); ++c) {
    if (columns[c].starts_with(kToleranceOf))
      found.plan.bounded.push_back(columns[c].substr(kToleranceOf.size()));
    else
      found.plan.metrics.push_back(columns[c]);
  }
  if (columns != sweep_columns(found.plan))
    fail_in_file(file, "is not the table of the sweep that sweep.json describes");

  std::vector<Condition> all;
  for (const std::string& text : conditions) all.emplace_back(text, columns);
  try {
    while (std::getline(in, line)) {
      SweepRow row = sweep_row(found.plan, line);
      if (!std::ranges::all_of(all, [&row](const Condition& c) { return c.holds(row.cells); })) continue;
      found.report.counts.add(row);
      if (found.report.rows.size() < SweepReport::kMostRows) found.report.rows.push_back(std::move(row));
    }
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
  found.report.done = found.plan.cases.size();
  return found;
}

}  // namespace hapbench
