#include "scenarios/program/sure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "scenarios/batch/finer_scene.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kSureLevels = 3;
constexpr double kSureRatio = 2.0;

std::string levels_text(const LevelSweep& levels) {
  std::vector<std::string> values = levels.axis.values;
  if (values.front() == "null") values.front() = "the mesh's own points";
  return fmt::format("{} {}", levels.axis.path, fmt::join(values, ", "));
}

}  // namespace

std::string sure_number(double value, const std::optional<double>& error) {
  if (error && *error == 0.0) return significant(value, 6);
  return error && *error >= std::abs(value) ? significant(value, 1) : deserved(value, error);
}

std::string sure_text(double value, const std::optional<double>& error) {
  return fmt::format("{} +- {}", sure_number(value, error), error ? significant(*error, 1) : "?");
}

SureStudy::SureStudy(const ScenarioText& scenario, const std::vector<std::string>& overrides,
                     const std::vector<std::string>& algorithms, const std::filesystem::path& directory, unsigned jobs,
                     const OutputOptions& output) {
  SweepOptions options;
  options.jobs = jobs == 0 ? available_threads() : jobs;
  options.progress = !output.quiet;
  const LoadedScenario loaded = load_scenario(scenario, overrides);
  check_named_files(loaded);  // the run has told its warnings
  const auto ran = [&](const std::string& path, const char* folder) {
    std::vector<Axis> axes;
    if (!algorithms.empty()) axes.push_back({.path = "rendering.algorithm", .values = algorithms});
    LevelSweep levels = level_sweep(loaded, path, kSureLevels, kSureRatio, true);
    axes.push_back(levels.axis);
    SweepPlan plan = plan_sweep(Cases({scenario}, overrides, std::move(axes)), options.jobs, options.progress);
    options.directory = directory / folder;
    require_writable_directory(options.directory);
    SweepReport report = run_sweep(plan, options);
    if (report.signal != 0) {
      std::filesystem::remove(options.directory / "sweep.csv.part");  // it is not resumed
      throw Stopped{report.signal};
    }
    return Part{std::move(levels), std::move(plan), std::move(report)};
  };
  step_ = ran(kStepPath, "sure_step");
  const FinerScene finer = with_finer_spacing(loaded, 2);
  if (finer.overrides.empty()) {
    no_spacing_ = finer.change;
    return;
  }
  try {
    spacing_ = ran(point_distance(loaded)->path, "sure_spacing");
  } catch (const InputError& problem) {
    no_spacing_ = fmt::format("the spacing is not refined: {}", problem.problem());
  }
}

SureStudy::Number SureStudy::number(std::size_t algorithm, const std::string& metric) const {
  const auto error = [&](const Part& part) {
    const auto rows = std::span(part.report.rows).subspan(algorithm * kSureLevels, kSureLevels);
    return convergence_of(part.levels, part.plan, rows, metric).errors.front();
  };
  Number number{level_result(step_->plan, step_->report.rows[algorithm * kSureLevels], metric), error(*step_)};
  if (spacing_) number.spacing = error(*spacing_);
  if (number.step && (number.spacing || !spacing_)) number.error = *number.step + number.spacing.value_or(0.0);
  return number;
}

std::string SureStudy::text(const std::string& title, const std::vector<std::string>& names) const {
  std::vector<Table::Column> columns = {{title, false}};
  std::vector<RunHeading> headings;
  std::ranges::copy_if(kRunHeadings, std::back_inserter(headings), [](const auto& h) { return h.factor != 0.0; });
  for (const RunHeading& heading : headings) columns.push_back({heading.title});
  Table table(columns);
  for (std::size_t a = 0; a < names.size(); ++a) {
    std::vector<std::string> cells = {names[a]};
    for (const RunHeading& heading : headings) {
      const Number found = number(a, heading.shows[0]);
      const auto error = found.error ? std::optional(heading.factor * *found.error) : std::nullopt;
      cells.push_back(found.value ? sure_text(heading.factor * *found.value, error) : "-");
    }
    table.add(std::move(cells));
  }
  const std::string spacing =
      spacing_ ? fmt::format(", and by {}, together", levels_text(spacing_->levels)) : fmt::format("; {}", no_spacing_);
  return fmt::format(
      "\nhow sure\n\n{}\n{}", table.text(prose_width()),
      wrapped(fmt::format("+-: how far finer runs move it, by {}{}. ?: a finer run ends otherwise or has no "
                          "such number. \"hapbench converge\" tells more",
                          levels_text(step_->levels), spacing),
              0));
}

Json SureStudy::json(std::size_t algorithm) const {
  Json json = Json::object();
  for (const std::string& metric : step_->plan.metrics) {
    const Number found = number(algorithm, metric);
    json[metric] = {{"value", or_null(found.value)},
                    {"error_estimate", or_null(found.error)},
                    {"error_of_step", or_null(found.step)},
                    {"error_of_spacing", or_null(found.spacing)}};
  }
  return json;
}

}  // namespace hapbench
