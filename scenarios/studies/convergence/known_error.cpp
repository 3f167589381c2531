#include "scenarios/studies/convergence/known_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/scene_facts.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kErrorLevels = 3;
constexpr double kErrorRatio = 2.0;

LevelSweep spacing_levels(const LoadedScenario& loaded, const PointDistance& distance) {
  LevelSweep levels = level_sweep(loaded, distance.path, kErrorLevels, kErrorRatio);
  if (!distance.is_given) {
    levels.no_order = "the mesh's own points are not as far apart everywhere as those of the other levels";
    levels.axis.values.front() = "the mesh's own";
  }
  return levels;
}

/// The runs of a scene's finer levels. Throws InputError where one of them cannot be run.
Cases finer_cases(const LevelSweep& levels, const Cases& cases) {
  Axis axis = levels.axis;
  axis.values.erase(axis.values.begin());
  if (!axis.along.empty()) axis.along.erase(axis.along.begin());
  std::vector<Axis> axes = cases.axes();
  axes.insert(axes.begin(), axis);
  Cases finer(cases.scenes(), cases.sets(), std::move(axes));
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    try {
      check_named_files(finer.load(i * cases.size()));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{} = {}: {}", axis.path, axis.values[i], error.problem()));
    }
  }
  return finer;
}

}  // namespace

std::optional<double> KnownError::sum() const {
  if (!step || (has_points && !spacing)) return std::nullopt;
  return *step + spacing.value_or(0.0) + tolerance;
}

FinerRuns::FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs)
    : comparison_(comparison), reports_(reports) {
  std::vector<Cases> finer;
  std::size_t runs = 0;
  const auto add = [&](Part& part, const Cases& cases) {
    try {
      finer.push_back(finer_cases(part.levels, cases));
      part.first = runs;
      runs += finer.back().size();
    } catch (const InputError& error) {
      part.why_not = error.what();
    }
  };
  for (const Cases& cases : comparison.scenes) {
    const LoadedScenario loaded = cases.load(0);
    Parts& parts = parts_.emplace_back();
    parts.step.levels = level_sweep(loaded, kStepPath, kErrorLevels, kErrorRatio);
    add(parts.step, cases);
    parts.has_points = !std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment);
    if (const auto distance = point_distance(loaded)) {
      parts.spacing.levels = spacing_levels(loaded, *distance);
      add(parts.spacing, cases);
    } else {
      parts.spacing.why_not = parts.has_points
                                  ? "no field sets the distance of the points; only a finer file could tell"
                                  : "springs have no points";
    }
  }
  finer_ = run_all(finer, jobs);
}

std::optional<double> FinerRuns::error_by(const Part& part, std::size_t run, const std::string& metric) const {
  if (!part.why_not.empty()) return std::nullopt;
  const std::size_t each = comparison_.each();
  std::vector<LevelResult> results = {level_result(part.levels, 0, reports_[run], metric)};
  for (std::size_t i = 1; i < kErrorLevels; ++i) {
    const Result& level = finer_[part.first + (i - 1) * each + run % each];
    results.push_back(level_result(part.levels, i, level, metric));
  }
  return convergence_of(part.levels, results).errors.front();
}

KnownError FinerRuns::known_error(std::size_t run, const std::string& metric) const {
  const Parts& parts = parts_[comparison_.scene(run)];
  KnownError known{.step = error_by(parts.step, run, metric),
                   .spacing = error_by(parts.spacing, run, metric),
                   .has_points = parts.has_points};
  const MetricList& metrics = reports_[run].metrics;
  if (const Metric* found = find_metric(metrics, metric)) known.tolerance = found->tolerance().value_or(0.0);
  return known;
}

std::string FinerRuns::refined(std::size_t scene) const {
  const auto text = [](const Part& part) {
    if (!part.why_not.empty()) return part.why_not;
    return fmt::format("{} {}", part.levels.axis.path, fmt::join(part.levels.axis.values, ", "));
  };
  return fmt::format("{}; {}", text(parts_[scene].step), text(parts_[scene].spacing));
}

namespace {

/// Whether the first of two numbers is less by more than both errors and by more than rounding.
using IsLess = std::function<bool(std::size_t, std::size_t)>;

/// Cuts a sorted order wherever all to the left are less than all to the right.
std::vector<std::vector<std::size_t>> cut(std::span<const std::size_t> order, const IsLess& is_less) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool is_cut = std::ranges::all_of(order.first(k), [&](std::size_t a) {
      return std::ranges::all_of(order.subspan(k), [&](std::size_t b) { return is_less(a, b); });
    });
    if (is_cut) groups.emplace_back();
    groups.back().push_back(order[k]);
  }
  return groups;
}

/// The member of a group that is apart from the fewest others, of several the one with the largest error; none where
/// no two are apart.
std::optional<std::size_t> least_sure(const std::vector<std::size_t>& group, std::span<const NumberWithError> numbers,
                                      const IsLess& is_less) {
  std::optional<std::size_t> found;
  std::ptrdiff_t fewest = 0, all = 0;
  for (const std::size_t a : group) {
    const auto apart = std::ranges::count_if(group, [&](std::size_t b) { return is_less(a, b) || is_less(b, a); });
    all += apart;
    if (found && (apart > fewest || (apart == fewest && *numbers[a].error <= *numbers[*found].error))) continue;
    found = a;
    fewest = apart;
  }
  return all > 0 ? found : std::nullopt;
}

std::string joined(std::span<const std::size_t> places, std::span<const std::string> names, const char* between) {
  std::vector<std::string> found;
  for (const std::size_t i : places) found.push_back(names[i]);
  return fmt::format("{}", fmt::join(found, between));
}

}  // namespace

HeldOrder held_order(std::span<const NumberWithError> numbers, double rounding) {
  const IsLess is_less = [&](std::size_t a, std::size_t b) {
    const double apart = *numbers[b].value - *numbers[a].value;
    return apart > *numbers[a].error + *numbers[b].error &&
           apart > rounding * std::max(std::abs(*numbers[a].value), std::abs(*numbers[b].value));
  };
  std::vector<std::size_t> sorted;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && numbers[i].error) sorted.push_back(i);
  std::ranges::stable_sort(sorted, {}, [&](std::size_t i) { return *numbers[i].value; });
  HeldOrder held;
  for (bool again = true; again;) {
    again = false;
    held.groups = cut(sorted, is_less);
    for (const std::vector<std::size_t>& group : held.groups) {
      const auto unsure = least_sure(group, numbers, is_less);
      if (!unsure) continue;
      held.unplaced.push_back(*unsure);
      std::erase(sorted, *unsure);
      again = true;
    }
  }
  return held;
}

std::string held_text(std::span<const NumberWithError> numbers, std::span<const std::string> names, double rounding) {
  const auto [groups, unplaced] = held_order(numbers, rounding);
  std::vector<std::string> parts;
  std::size_t placed = 0;
  for (const std::vector<std::size_t>& group : groups) {
    parts.push_back(joined(group, names, " ~ "));
    placed += group.size();
  }
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && !numbers[i].error) unknown.push_back(i);
  const char* says = placed < 2                                    ? "there is nothing to compare"
                     : groups.size() == 1                          ? "no order holds: "
                     : groups.size() == placed && unplaced.empty() ? "the order holds: "
                                                                   : "what holds is <: ";
  std::string text = says + (placed < 2 ? "" : fmt::format("{}", fmt::join(parts, " < ")));
  if (!unplaced.empty()) text += "; too uncertain for a place: " + joined(unplaced, names, ", ");
  if (!unknown.empty()) text += "; no error is known of " + joined(unknown, names, ", ");
  return text;
}

}  // namespace hapbench
