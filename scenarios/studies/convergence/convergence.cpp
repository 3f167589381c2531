#include "scenarios/studies/convergence/convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/scene_facts.hpp"
#include "scenarios/studies/stability/field_limit.hpp"
#include "sim/core/math.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// Of the step. A device samples: between its samples the force is held, which is of the first order.
double order_in_step(const Scenario& scenario) {
  const IntegratorEntry& integrator = *scenario.integrator.type;
  if (!std::holds_alternative<IdealDeviceFields>(scenario.device)) return 1.0;
  const RenderingConfig& r = scenario.rendering;
  return normal_damping(r) > 0.0 || r.has_friction() ? integrator.damped_order : integrator.order;
}

std::string noise_reason(const Scenario& scenario) {
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device);
  const char* source = std::holds_alternative<TrackingHandFields>(scenario.hand) ? "hand"
                       : admittance != nullptr && admittance->sensor.noise > 0.0 ? "force sensor"
                                                                                 : nullptr;
  return source == nullptr ? "" : fmt::format("the noise of the {} is drawn anew in every step", source);
}

/// Delays of devices keep their length.
std::vector<std::string> kept_delays(const Scenario& scenario, std::int64_t times) {
  std::vector<std::string> overrides;
  const auto keep = [&overrides, times](const char* field, auto steps) {
    if (steps > 0) overrides.push_back(fmt::format("{}={}", field, static_cast<decltype(steps)>(times) * steps));
  };
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device))
    keep("device.delay_samples", device->delay_samples);
  if (const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device))
    keep("device.servo.delay_samples", device->servo.delay);
  return overrides;
}

LevelSweep step_levels(const Scenario& scenario, std::size_t levels, double ratio) {
  if (ratio != std::round(ratio)) {
    throw InputError(fmt::format(
        "--ratio: got {}; allowed for {}: whole numbers, so that the rows of all levels coincide", ratio, kStepPath));
  }
  LevelSweep sweep{.axis = {kStepPath}, .formal_order = order_in_step(scenario), .no_order = noise_reason(scenario)};
  std::int64_t times = 1;
  for (std::size_t i = 0; i < levels; ++i, times *= static_cast<std::int64_t>(ratio)) {
    std::vector<std::string> overrides = kept_delays(scenario, times);
    overrides.insert(overrides.begin(), fmt::format("time.steps={}", times * scenario.time.steps));
    sweep.axis.values.push_back(fmt::format("{}", scenario.time.step / static_cast<double>(times)));
    sweep.axis.along.push_back({std::move(overrides), times});
  }
  return sweep;
}

/// The field's value in the scenario.
double coarsest_value(const LoadedScenario& loaded, const std::string& path) {
  const Json own = own_value(loaded.scenario, path);
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

}  // namespace

LevelSweep level_sweep(const LoadedScenario& loaded, const std::string& path, std::size_t levels, double ratio) {
  LevelSweep sweep;
  if (path == kStepPath) {
    sweep = step_levels(loaded.scenario, levels, ratio);
  } else {
    sweep.axis = {path};
    double value = coarsest_value(loaded, path);
    for (std::size_t i = 0; i < levels; ++i, value /= ratio)
      sweep.axis.values.emplace_back(std::string_view(NumberText(value)));
  }
  sweep.ratio = ratio;
  return sweep;
}

namespace {

/// Smaller differences, relative to the results, are rounding errors of as many as 10^6 steps and say nothing about the
/// order.
constexpr double kRoundingShare = 1e-10;
constexpr double kGciSafety = 1.25;        // Roache's factor for three and more levels
constexpr double kAsymptoticWithin = 0.1;  // of GCI_21 / (r^p GCI_32) from 1
constexpr std::size_t kLeastLevels = 3;

/// The first level of those that count.
std::size_t first_counted(std::span<const LevelResult> levels) {
  std::size_t first = levels.size();
  while (first > 0 && levels[first - 1].result && levels[first - 1].outcome == levels.back().outcome) --first;
  return first;
}

std::string too_few_reason(std::span<const LevelResult> levels, std::size_t first) {
  const std::size_t count = levels.size() - first;
  if (first == 0) return fmt::format("{} levels are fewer than three", count);
  const LevelResult& last = levels[first - 1];
  if (count == 0)
    return fmt::format("the finest run, at {}, has no value of the metric ({})", last.setting, last.outcome);
  const std::string why = last.result ? fmt::format("ends with {}", last.outcome)
                                      : fmt::format("has no value of the metric ({})", last.outcome);
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

}  // namespace

Convergence convergence_of(std::span<const LevelResult> levels, double ratio, double formal_order,
                           const std::string& no_order) {
  Convergence c;
  c.orders.resize(levels.size());
  c.errors.resize(levels.size());
  const std::size_t first = first_counted(levels), count = levels.size() - first;
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
      c.orders[first + i] = math::log(coarse / fine) / math::log(ratio);
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

  if (c.reason = no_order; !c.reason.empty()) return c;
  if (count < kLeastLevels) {
    c.reason = too_few_reason(levels, first);
  } else if (is_rounding(f[count - 2] - f[count - 1])) {
    c.reason = "the last levels differ by rounding only";
  } else if (c.reason = switching_reason(levels.last(kLeastLevels)); c.reason.empty()) {
    c.reason = incredible_reason(f, std::span(c.orders).subspan(first), 2.0 * formal_order);
  }
  if (!c.reason.empty()) return c;

  const double p = *c.orders.back(), growth = math::pow(ratio, p), fine = f[count - 1] - f[count - 2];
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

namespace {

/// Counts of contacts at the rows that the metrics take in, by which contacts are said to switch. Other points come
/// with another surface: then it is the first that tells whether the tool meets the same things.
constexpr const char* kContactCounts[] = {"landings", "steps_in_contact", "colliding_mean", "rendered_mean"};

}  // namespace

LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary,
                         const std::string& metric) {
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

Convergence convergence_of(const LevelSweep& levels, std::span<const LevelResult> results) {
  const auto is_first = [&](const LevelResult& level) { return level.state_hash == results.front().state_hash; };
  const bool alike = results.size() > 1 && results.back().result && std::ranges::all_of(results, is_first);
  return convergence_of(results, levels.ratio, levels.formal_order,
                        alike
                            ? fmt::format("{} has no effect here: all runs are the same, bit for bit", levels.axis.path)
                            : levels.no_order);
}

}  // namespace hapbench
