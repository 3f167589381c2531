#include "scenarios/analysis/convergence/finer_runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <variant>

#include "results/io/columns.hpp"
#include "scenarios/analysis/convergence/observed_order.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/scene_checks.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kErrorLevels = 3;
constexpr double kErrorRatio = 2.0;

/// Returns the levels of the spacing between surface points. Throws InputError if the spacing cannot be refined.
LevelSweep spacing_levels(const LoadedScenario& loaded, bool has_points) {
  const auto distance = point_distance(loaded);
  if (!distance)
    throw InputError(has_points ? "point spacing not refined, because no field sets it (a finer file would be needed)"
                                : "point spacing not refined, because springs have no points");
  LevelSweep levels = level_sweep(loaded, distance->path, kErrorLevels, kErrorRatio);
  if (!distance->is_given) {
    levels.no_order = "the spacing of the mesh's vertices is not uniform, unlike the spacing at the other levels";
    levels.axis.values.front() = "the mesh's vertices";
  }
  return levels;
}

}  // namespace

std::optional<double> KnownError::sum() const {
  if (!step || (has_points && !spacing)) return std::nullopt;
  return *step + spacing.value_or(0.0) + tolerance;
}

FinerRuns::FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs)
    : comparison_(comparison), reports_(reports) {
  // Collect the refined cases of all scenes. For an impossible refinement, store the reason.
  std::vector<Cases> finer;
  std::size_t runs = 0;
  const auto part_of = [&](const Cases& cases, const std::function<LevelSweep()>& levels) {
    Part part;
    try {
      part.levels = levels();
      finer.push_back(finer_cases(part.levels, cases));
      part.first = runs;
      runs += finer.back().size();
    } catch (const InputError& error) {
      part.why_not = error.what();
    }
    return part;
  };
  for (const Cases& cases : comparison.scenes) {
    const LoadedScenario loaded = cases.load(0);
    const bool has_points = !std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment);
    scenes_.push_back({part_of(cases, [&] { return level_sweep(loaded, kStepPath, kErrorLevels, kErrorRatio); }),
                       part_of(cases, [&] { return spacing_levels(loaded, has_points); }), has_points});
  }
  finer_ = run_all(finer, jobs, {}, comparison.length);
}

KnownError FinerRuns::known_error(std::size_t run, const std::string& metric) const {
  const auto& [step, spacing, has_points] = scenes_[comparison_.scene(run)];
  KnownError known{error_by(step, run, metric), error_by(spacing, run, metric), has_points};
  if (const Metric* found = find_metric(reports_[run].metrics, metric))
    known.tolerance = found->tolerance().value_or(0.0);
  return known;
}

std::optional<double> FinerRuns::error_by(const Part& part, std::size_t run, const std::string& metric) const {
  if (!part.why_not.empty()) return std::nullopt;
  const std::size_t each = comparison_.each();
  std::vector<LevelResult> results = {level_result(part.levels, 0, reports_[run], metric)};
  for (std::size_t i = 1; i < kErrorLevels; ++i) {
    const Result& level = finer_[part.first + (i - 1) * each + run % each];
    results.push_back(level_result(part.levels, i, level, metric));
  }
  return convergence_of(part.levels, results, traits_of(reports_[run].metrics, metric)).errors.front();
}

std::string FinerRuns::refined(std::size_t scene) const {
  const auto text = [](const Part& part) {
    if (!part.why_not.empty()) return part.why_not;
    std::vector<std::string> values;
    for (std::size_t i = 0; i < part.levels.axis.values.size(); ++i) values.push_back(level_text(part.levels, i));
    return fmt::format("{} {}", part.levels.axis.path, fmt::join(values, ", "));
  };
  return fmt::format("{}; {}", text(scenes_[scene].step), text(scenes_[scene].spacing));
}

}  // namespace hapbench
