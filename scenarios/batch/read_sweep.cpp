#include "scenarios/batch/read_sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scenarios/batch/table_file.hpp"
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
  const std::size_t first_metric =
      found.plan.cases.axes().size() + 4;  // behind index, fields, outcome, expected, steps
  if (columns.size() <= first_metric) fail_in_file(file, "is not the table of a sweep");
  for (std::size_t c = first_metric; c + 1 < columns.size(); ++c) {
    if (columns[c].starts_with(kToleranceOf))
      found.plan.bounded.push_back(columns[c].substr(kToleranceOf.size()));
    else
      found.plan.metrics.push_back(columns[c]);
  }
  if (line != sweep_header(found.plan)) fail_in_file(file, "is not the table of the sweep that sweep.json describes");

  std::vector<Condition> all;
  for (const std::string& text : conditions) all.emplace_back(text, columns);
  while (std::getline(in, line)) {
    const std::vector<std::string> cells = csv_cells(line);
    std::optional<SweepRow> row = parse_row(found.plan, line);
    if (!row) fail_in_file(file, fmt::format("got the row \"{}\"; allowed: rows of this sweep", line.substr(0, 60)));
    if (!std::all_of(all.begin(), all.end(), [&](const Condition& c) { return c.holds(cells); })) continue;
    found.report.counts.add(*row);
    if (found.report.rows.size() < SweepReport::kMostRows) found.report.rows.push_back(std::move(*row));
  }
  found.report.done = found.plan.cases.size();
  return found;
}

}  // namespace hapbench
