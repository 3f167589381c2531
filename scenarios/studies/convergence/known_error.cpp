#include "scenarios/studies/convergence/known_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "scenarios/batch/finer_scene.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kErrorLevels = 3;
constexpr double kErrorRatio = 2.0;

/// The overrides of a level.
FinerScene level_of(const LevelSweep& levels, std::size_t level) {
  FinerScene scene{{fmt::format("{}={}", levels.axis.path, levels.axis.values[level])}};
  if (levels.axis.along.empty()) return scene;
  const auto& [overrides, stride] = levels.axis.along[level];
  scene.overrides.insert(scene.overrides.end(), overrides.begin(), overrides.end());
  scene.stride = stride;
  return scene;
}

LevelSweep spacing_levels(const LoadedScenario& loaded, const PointDistance& distance) {
  LevelSweep levels = level_sweep(loaded, distance.path, kErrorLevels, kErrorRatio);
  if (!distance.is_given) {
    levels.no_order = "the mesh's own points are not as far apart everywhere as those of the other levels";
    levels.axis.values.front() = "the mesh's own";
  }
  return levels;
}

}  // namespace

std::optional<double> KnownError::sum() const {
  if (!step || (has_points && !spacing)) return std::nullopt;
  return *step + spacing.value_or(0.0) + tolerance;
}

FinerRuns::FinerRuns(const BatchPlan& plan, const BatchReport& report, BatchOptions options)
    : plan_(plan), report_(report), finer_plan_(plan) {
  finer_plan_.scenarios.clear();
  finer_plan_.names.clear();
  const std::size_t each = plan.size() / plan.scenarios.size();
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    const LoadedScenario loaded = scenario_of(plan, s * each);
    Parts parts;
    parts.step.levels = level_sweep(loaded, kStepPath, kErrorLevels, kErrorRatio);
    add(parts.step, plan, s);
    parts.has_points = !std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment);
    if (const auto distance = point_distance(loaded)) {
      parts.spacing.levels = spacing_levels(loaded, *distance);
      add(parts.spacing, plan, s);
    } else {
      parts.spacing.why_not = parts.has_points
                                  ? "no field sets the distance of the points; only a finer file could tell"
                                  : "springs have no points";
    }
    parts_.push_back(std::move(parts));
  }
  options.directory.reset();
  finer_ = run_batch(finer_plan_, options);
}

/// Adds the finer levels of a scenario to the plan, unless one of them cannot be run.
void FinerRuns::add(Part& part, const BatchPlan& plan, std::size_t scenario) {
  part.half = finer_plan_.scenarios.size();
  std::vector<FinerScene> levels;
  for (std::size_t i = 1; i < kErrorLevels; ++i) {
    levels.push_back(level_of(part.levels, i));
    std::vector<std::string> overrides = plan.definition.overrides;
    overrides.push_back("rendering.algorithm=" + plan.definition.algorithms[0]);
    overrides.insert(overrides.end(), levels.back().overrides.begin(), levels.back().overrides.end());
    try {
      check_named_files(load_scenario(plan.scenarios[scenario], overrides));
    } catch (const InputError& error) {
      part.why_not = fmt::format("{} = {}: {}", part.levels.axis.path, part.levels.axis.values[i], error.problem());
      return;
    }
  }
  for (FinerScene& level : levels) {
    finer_plan_.scenarios.push_back(plan.scenarios[scenario]);
    finer_plan_.names.push_back(plan.names[scenario]);
    finer_plan_.finer.push_back(std::move(level));
  }
}

std::optional<double> FinerRuns::error_by(const Part& part, std::size_t run, const std::string& metric) const {
  if (!part.why_not.empty()) return std::nullopt;
  const std::size_t each = plan_.size() / plan_.scenarios.size();
  std::vector<LevelResult> results;
  for (std::size_t i = 0; i < kErrorLevels; ++i) {
    const RunReport& level = i == 0 ? report_.runs[run] : finer_.runs[(part.half + i - 1) * each + run % each];
    results.push_back(level_result(part.levels, i, level.summary, metric));
  }
  return convergence_of(part.levels, results).errors.front();
}

KnownError FinerRuns::known_error(std::size_t run, const std::string& metric) const {
  const Parts& parts = parts_[plan_.run(run).scenario];
  KnownError known{.step = error_by(parts.step, run, metric),
                   .spacing = error_by(parts.spacing, run, metric),
                   .has_points = parts.has_points};
  const MetricList metrics = metric_list(report_.runs[run].summary);
  if (const Metric* found = find_metric(metrics, metric)) known.tolerance = found->tolerance().value_or(0.0);
  return known;
}

std::string FinerRuns::refined(std::size_t scenario) const {
  const auto text = [](const Part& part) {
    if (!part.why_not.empty()) return part.why_not;
    return fmt::format("{} {}", part.levels.axis.path, fmt::join(part.levels.axis.values, ", "));
  };
  return fmt::format("{}; {}", text(parts_[scenario].step), text(parts_[scenario].spacing));
}

namespace {

/// Orders numbers that have a value and an error.
class NumberOrder {
 public:
  NumberOrder(std::span<const NumberWithError> numbers, double rounding) : numbers_(numbers), rounding_(rounding) {}

  double value(std::size_t i) const { return *numbers_[i].value; }

  bool is_less(std::size_t a, std::size_t b) const {
    const double apart = value(b) - value(a);
    return apart > *numbers_[a].error + *numbers_[b].error &&
           apart > rounding_ * std::max(std::abs(value(a)), std::abs(value(b)));
  }

  /// Cuts a sorted order wherever all to the left are less than all to the right.
  std::vector<std::vector<std::size_t>> cut(std::span<const std::size_t> order) const {
    std::vector<std::vector<std::size_t>> groups;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const auto left = order.first(k), right = order.subspan(k);
      const bool is_cut = std::ranges::all_of(left, [&](std::size_t a) {
        return std::ranges::all_of(right, [&](std::size_t b) { return is_less(a, b); });
      });
      if (is_cut) groups.emplace_back();
      groups.back().push_back(order[k]);
    }
    return groups;
  }

  /// The member of a group that is apart from the fewest others, of several the one with the largest error; none where
  /// no two are apart.
  std::optional<std::size_t> least_sure(const std::vector<std::size_t>& group) const {
    std::optional<std::size_t> found;
    std::ptrdiff_t fewest = 0, all = 0;
    for (const std::size_t a : group) {
      const auto apart = std::ranges::count_if(group, [&](std::size_t b) { return is_less(a, b) || is_less(b, a); });
      all += apart;
      if (found && (apart > fewest || (apart == fewest && *numbers_[a].error <= *numbers_[*found].error))) continue;
      found = a;
      fewest = apart;
    }
    return all > 0 ? found : std::nullopt;
  }

 private:
  std::span<const NumberWithError> numbers_;
  double rounding_;
};

std::string joined(std::span<const std::size_t> places, std::span<const std::string> names, const char* between) {
  std::vector<std::string> found;
  for (const std::size_t i : places) found.push_back(names[i]);
  return fmt::format("{}", fmt::join(found, between));
}

}  // namespace

HeldOrder held_order(std::span<const NumberWithError> numbers, double rounding) {
  const NumberOrder order(numbers, rounding);
  std::vector<std::size_t> sorted;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && numbers[i].error) sorted.push_back(i);
  std::ranges::stable_sort(sorted, {}, [&order](std::size_t i) { return order.value(i); });
  HeldOrder held;
  for (bool again = true; again;) {
    again = false;
    held.groups = order.cut(sorted);
    for (const std::vector<std::size_t>& group : held.groups) {
      const auto unsure = order.least_sure(group);
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
