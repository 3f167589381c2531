#include "scenarios/analysis/convergence/convergence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/io/columns.hpp"
#include "scenarios/analysis/current_value.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/core/math.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

// ---- Levels

/// Formal order in the step. A device samples: between its samples the force is held, which is of the first order.
double order_in_step(const Scenario& scenario) {
  const IntegratorEntry& integrator = *scenario.integrator.type;
  if (has_device(scenario)) return 1.0;
  const RenderingConfig& r = scenario.rendering;
  return normal_damping(r) > 0.0 || r.has_friction() ? integrator.damped_order : integrator.order;
}

std::string noise_reason(const Scenario& scenario) {
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  if (std::holds_alternative<TrackingHandFields>(scenario.hand))
    return "the noise of the hand is drawn anew in every step";
  const bool senses = admittance != nullptr && admittance->sensor.noise > 0.0;
  return senses ? "the noise of the force sensor is drawn anew in every step" : "";
}

LevelSweep step_levels(const Scenario& scenario, std::size_t levels, double ratio) {
  if (ratio != std::round(ratio))
    throw InputError(fmt::format(
        "--ratio: got {}; allowed for {}: whole numbers, so that the rows of all levels coincide", ratio, kStepPath));
  LevelSweep sweep{{kStepPath}, ratio, order_in_step(scenario), noise_reason(scenario)};
  std::int64_t times = 1;
  for (std::size_t i = 0; i < levels; ++i, times *= static_cast<std::int64_t>(ratio)) {
    std::vector<std::string> overrides = {fmt::format("time.steps={}", times * scenario.time.steps)};
    if (const double delay = delay_of(scenario); delay > 0.0)  // which keeps its length
      overrides.push_back(fmt::format("{}={}", delay_path(scenario), static_cast<double>(times) * delay));
    sweep.axis.values.push_back(fmt::format("{}", scenario.time.step / static_cast<double>(times)));
    sweep.axis.along.push_back({std::move(overrides), times});
  }
  return sweep;
}

double coarsest_value(const LoadedScenario& loaded, const std::string& path) {
  const Json own = current_value(loaded.scenario, path);
  if (own.is_number_float() && own.get<double>() > 0.0) return own.get<double>();
  if (own.is_null()) {
    const auto distance = point_distance(loaded);
    if (distance && path == distance->path) return distance->metres;
  }
  throw InputError(
      fmt::format("--vary: got {}, which is {} in the scenario; allowed: a field that is a number > 0 and no "
                  "integer, such as {}, environment.grid_m, environment.spacing_m or tool.grid_m",
                  path, own.is_null() ? "not given" : own.dump(), kStepPath));
}

// ---- The order

/// Smaller differences, relative to the results, are rounding errors of up to 10^6 steps and say nothing of the order.
constexpr double kRoundingShare = 1e-10;
constexpr double kGciSafety = 1.25;        // Roache's factor for three and more levels
constexpr double kAsymptoticWithin = 0.1;  // of GCI_21 / (r^p GCI_32) from 1
constexpr std::size_t kLeastLevels = 3;

std::string too_few_reason(std::span<const LevelResult> levels, std::size_t first) {
  const std::size_t count = levels.size() - first;
  if (first == 0) return fmt::format("{} levels are fewer than three", count);
  const LevelResult& last = levels[first - 1];
  const std::string why =
      fmt::format(fmt::runtime(last.result ? "ends with {}" : "has no value of the metric ({})"), last.outcome);
  if (count == 0) return fmt::format("the finest run, at {}, {}", last.setting, why);
  return fmt::format("the run at {} {}, which leaves {} levels; an order takes three", last.setting, why, count);
}

/// The first count of contacts that differs between the levels.
std::string switching_reason(std::span<const LevelResult> last) {
  for (std::size_t i = 0; i < last.front().contacts.size(); ++i) {
    const auto& [name, coarse] = last.front().contacts[i];
    for (const LevelResult& level : last.subspan(1)) {
      if (level.contacts[i].second == coarse) continue;
      return fmt::format("contacts switch between the last levels ({} is {:.10g} at {}, {:.10g} at {})", name, coarse,
                         last.front().setting, level.contacts[i].second, level.setting);
    }
  }
  return "";
}

/// Why the orders and differences of the last four levels, or three, are not credible.
std::string incredible_reason(std::span<const double> f, std::span<const std::optional<double>> orders, double most) {
  const std::size_t last = f.size() - 1, from = last >= 3 ? last - 3 : 0;
  for (std::size_t i = from + 2; i <= last; ++i) {
    const double coarse = f[i - 2] - f[i - 1], fine = f[i - 1] - f[i];
    if (coarse * fine < 0.0) return "the differences between the last levels change their sign";
    if (!orders[i]) return "some of the last levels differ by rounding only";
    if (*orders[i] <= 0.0) return fmt::format("the differences do not shrink (order {:.2g})", *orders[i]);
    if (*orders[i] > most)
      return fmt::format("the order {:.3g} is not credible: more than twice the formal one, {:g}", *orders[i],
                         most / 2);
  }
  return "";
}

// ---- Finer runs

constexpr std::size_t kErrorLevels = 3;
constexpr double kErrorRatio = 2.0;

/// The levels of the distance between the points; or why there are none.
LevelSweep spacing_levels(const LoadedScenario& loaded, bool has_points) {
  const auto distance = point_distance(loaded);
  if (!distance)
    throw InputError(has_points ? "no field sets the distance of the points; only a finer file could tell"
                                : "springs have no points");
  LevelSweep levels = level_sweep(loaded, distance->path, kErrorLevels, kErrorRatio);
  if (!distance->is_given) {
    levels.no_order = "the mesh's own points are not as far apart everywhere as those of the other levels";
    levels.axis.values.front() = "the mesh's own";
  }
  return levels;
}

std::string joined(std::span<const std::size_t> places, std::span<const std::string> names, const char* between) {
  std::vector<std::string> found;
  for (const std::size_t i : places) found.push_back(names[i]);
  return fmt::format("{}", fmt::join(found, between));
}

}  // namespace

LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio) {
  if (path == kStepPath) return step_levels(loaded.scenario, levels, ratio);
  LevelSweep sweep{{path}, ratio};
  double value = coarsest_value(loaded, path);
  for (std::size_t i = 0; i < levels; ++i, value /= ratio)
    sweep.axis.values.emplace_back(std::string_view(NumberText(value)));
  return sweep;
}

Convergence convergence_of(const LevelSweep& sweep, std::span<const LevelResult> levels) {
  Convergence c;
  c.orders.resize(levels.size());
  c.errors.resize(levels.size());
  std::size_t first = levels.size();  // of the levels that count
  while (first > 0 && levels[first - 1].result && levels[first - 1].outcome == levels.back().outcome) --first;
  const std::size_t count = levels.size() - first;
  std::vector<double> f;
  double largest = 0.0;
  for (const LevelResult& level : levels.subspan(first)) {
    f.push_back(*level.result);
    largest = std::max(largest, std::abs(f.back()));
  }
  const auto is_rounding = [&](double difference) { return std::abs(difference) <= kRoundingShare * largest; };
  for (std::size_t i = 2; i < count; ++i) {
    const double coarse = f[i - 2] - f[i - 1], fine = f[i - 1] - f[i];
    if (!is_rounding(coarse) && !is_rounding(fine) && coarse * fine > 0.0)
      c.orders[first + i] = math::log(coarse / fine) / math::log(sweep.ratio);
  }
  if (count >= 2) {
    const auto last = f.end() - static_cast<std::ptrdiff_t>(std::min(count, kLeastLevels));
    c.band = {*std::min_element(last, f.end()), *std::max_element(last, f.end())};
    for (std::size_t i = 0; i < count; ++i) {
      double error = c.band->second - c.band->first;
      for (std::size_t j = i + 1; j < count; ++j) error = std::max(error, std::abs(f[i] - f[j]));
      c.errors[first + i] = error;
    }
  }

  const auto is_first = [&](const LevelResult& level) { return level.state_hash == levels.front().state_hash; };
  if (levels.size() > 1 && levels.back().result && std::ranges::all_of(levels, is_first)) {
    c.reason = fmt::format("{} has no effect here: all runs are the same, bit for bit", sweep.axis.path);
  } else if (!sweep.no_order.empty()) {
    c.reason = sweep.no_order;
  } else if (count < kLeastLevels) {
    c.reason = too_few_reason(levels, first);
  } else if (is_rounding(f[count - 2] - f[count - 1])) {
    c.reason = "the last levels differ by rounding only";
  } else if (c.reason = switching_reason(levels.last(kLeastLevels)); c.reason.empty()) {
    c.reason = incredible_reason(f, std::span(c.orders).subspan(first), 2.0 * sweep.formal_order);
  }
  if (!c.reason.empty()) return c;

  const double p = *c.orders.back(), growth = math::pow(sweep.ratio, p), fine = f[count - 1] - f[count - 2];
  c.order = p;
  c.extrapolated = f[count - 1] + fine / (growth - 1.0);
  if (f[count - 1] != 0.0) c.gci = kGciSafety * std::abs(fine) / (std::abs(f[count - 1]) * (growth - 1.0));
  for (std::size_t i = 0; i < count; ++i) c.errors[first + i] = kGciSafety * std::abs(f[i] - *c.extrapolated);
  const auto in_range = [&](std::size_t i) {  // of the levels i - 2, i - 1 and i
    const double gci_21 = (f[i - 1] - f[i - 2]) / std::abs(f[i - 1]), gci_32 = (f[i] - f[i - 1]) / std::abs(f[i]);
    return std::abs(gci_21 / (growth * gci_32) - 1.0) <= kAsymptoticWithin;
  };
  c.asymptotic = in_range(count - 1) && (count == kLeastLevels || in_range(count - 2));
  return c;
}

LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary,
                         const std::string& metric) {
  // Counts at the rows that the metrics take in, by which contacts are said to switch. Other points come with another
  // surface: then it is the first that tells whether the tool meets the same things.
  constexpr const char* kContactCounts[] = {"landings", "steps_in_contact", "colliding_mean", "rendered_mean"};
  const std::string& path = levels.axis.path;
  LevelResult result{.setting = fmt::format("{} = {}", path, levels.axis.values[level]),
                     .outcome = std::string(outcome_name(summary.end.outcome)),
                     .result = std::nullopt,
                     .state_hash = summary.state_hash};
  if (summary.end.outcome != Outcome::diverges) result.result = number_of(summary.metrics, metric);
  const std::span<const char* const> counts = kContactCounts;
  for (const char* name : counts.first(path.starts_with("environment.") ? 1 : counts.size()))
    result.contacts.emplace_back(name, number_of(summary.metrics, name).value_or(0.0));
  return result;
}

Cases finer_cases(const LevelSweep& levels, const Cases& cases) {
  Axis axis = levels.axis;
  axis.values.erase(axis.values.begin());
  if (!axis.along.empty()) axis.along.erase(axis.along.begin());
  std::vector<Axis> axes = cases.axes();
  axes.insert(axes.begin(), axis);
  Cases finer(cases.scenes(), cases.sets(), std::move(axes));
  for (std::size_t i = 0; i < axis.values.size(); ++i) {
    try {
      checked(finer.load(i * cases.size()));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{} = {}: {}", axis.path, axis.values[i], error.problem()));
    }
  }
  return finer;
}

FinerRuns::FinerRuns(const Comparison& comparison, std::span<const Result> reports, const JobOptions& jobs)
    : comparison_(comparison), reports_(reports) {
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

std::string FinerRuns::refined(std::size_t scene) const {
  const auto text = [](const Part& part) {
    if (!part.why_not.empty()) return part.why_not;
    return fmt::format("{} {}", part.levels.axis.path, fmt::join(part.levels.axis.values, ", "));
  };
  return fmt::format("{}; {}", text(scenes_[scene].step), text(scenes_[scene].spacing));
}

HeldOrder held_order(std::span<const NumberWithError> numbers) {
  const auto comes_before = [&](std::size_t a, std::size_t b) { return is_less(numbers[a], numbers[b]); };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && numbers[i].error) order.push_back(i);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return *numbers[i].value; });
  HeldOrder held;
  const auto is_alike = [&](std::size_t a) {
    return std::ranges::none_of(order, [&](std::size_t b) { return comes_before(a, b) || comes_before(b, a); });
  };
  std::ranges::copy_if(order, std::back_inserter(held.unplaced), is_alike);
  if (held.unplaced.size() == order.size()) held.unplaced.clear();
  std::erase_if(order, [&](std::size_t a) { return std::ranges::find(held.unplaced, a) != held.unplaced.end(); });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::span left = std::span(order).first(k), right = std::span(order).subspan(k);
    const bool is_cut = std::ranges::all_of(left, [&](std::size_t a) {
      return std::ranges::all_of(right, [&](std::size_t b) { return comes_before(a, b); });
    });
    if (is_cut) held.groups.emplace_back();
    held.groups.back().push_back(order[k]);
  }
  return held;
}

std::string held_text(std::span<const NumberWithError> numbers, std::span<const std::string> names) {
  const auto [groups, unplaced] = held_order(numbers);
  std::vector<std::string> parts;
  std::size_t placed = 0;
  for (const std::vector<std::size_t>& group : groups) {
    parts.push_back(joined(group, names, " ~ "));
    placed += group.size();
  }
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if (numbers[i].value && !numbers[i].error) unknown.push_back(i);
  const char* says = groups.size() == 1                            ? "no order holds: "
                     : groups.size() == placed && unplaced.empty() ? "the order holds: "
                                                                   : "the order holds in part: ";
  std::string text = placed < 2 ? "there is nothing to compare" : fmt::format("{}{}", says, fmt::join(parts, " < "));
  if (!unplaced.empty()) text += "; too uncertain for a place: " + joined(unplaced, names, ", ");
  if (!unknown.empty()) text += "; no error is known of " + joined(unknown, names, ", ");
  return text;
}

}  // namespace hapbench
