#include "scenarios/analysis/convergence/observed_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "results/io/columns.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// A difference between two results below this fraction of the largest result may be the rounding error of up to 10^6
/// steps. No order follows from such differences.
constexpr double kRoundingShare = 1e-10;
constexpr double kGciSafety = 1.25;        // Roache's safety factor for three or more levels
constexpr double kAsymptoticWithin = 0.1;  // largest |GCI_21 / (r^p GCI_32) - 1|
constexpr std::size_t kMinLevels = 3;
/// Minimum number of levels for an extreme, or for a metric that depends on events. Fewer levels can look regular by
/// chance: the event stays between the same two samples for some levels and then moves.
constexpr std::size_t kMinLevelsOfEvents = 5;

std::size_t min_levels(const MetricTraits& traits) {
  return traits.smooth ? kMinLevels : kMinLevelsOfEvents;
}

/// Returns the reason why fewer levels count (CountedLevels) than an order needs. `first`: index of the first level
/// that counts.
std::string too_few_reason(std::span<const LevelResult> levels, std::size_t first, const MetricTraits& traits) {
  const std::size_t count = levels.size() - first;
  const char* needed = traits.smooth ? "three" : "five";
  if (first == 0 && !traits.smooth)
    return fmt::format("an extreme, or a metric that depends on contact events, needs five levels; got {}", count);
  if (first == 0) return fmt::format("three levels are needed, got {}", count);
  const LevelResult& last = levels[first - 1];
  const std::string why = fmt::format(
      fmt::runtime(last.result ? "has the outcome {}" : "has no value of the metric (outcome {})"), last.outcome);
  if (count == 0) return fmt::format("the finest run, at {}, {}", last.setting, why);
  return fmt::format("the run at {} {}, which leaves {} levels, and an order needs {}", last.setting, why, count,
                     needed);
}

/// Returns a clause about the first contact count that differs between the levels; empty if none differs.
std::string switching_reason(std::span<const LevelResult> last) {
  for (std::size_t i = 0; i < last.front().contacts.size(); ++i) {
    const auto& [name, coarse] = last.front().contacts[i];
    for (const LevelResult& level : last.subspan(1)) {
      if (level.contacts[i].second == coarse) continue;
      return fmt::format(
          "contacts change between the last {} levels ({} is {:.10g} at {}, {:.10g} at {}; counted in recorded steps)",
          last.size(), name, coarse, last.front().setting, level.contacts[i].second, level.setting);
    }
  }
  return "";
}

/// Returns why the differences or orders of the last `count` results are not credible; empty if they are credible. `f`:
/// results, coarsest first. `formal`, `ratio`: as in LevelSweep.
std::string incredible_reason(std::span<const double> f, std::span<const std::optional<double>> orders,
                              std::size_t count, double formal, double ratio) {
  const std::size_t last = f.size() - 1, from = f.size() >= count ? f.size() - count : 0;
  // The largest credible order p: the ratio r^p of two successive differences may exceed the ratio for twice the formal
  // order by the fraction kAsymptoticWithin.
  const double largest_credible = 2.0 * formal + math::log(1.0 + kAsymptoticWithin) / math::log(ratio);
  for (std::size_t i = from + 2; i <= last; ++i) {
    const double coarse = f[i - 2] - f[i - 1], fine = f[i - 1] - f[i];
    if (coarse * fine < 0.0) return "the differences between the last levels change sign";
    if (!orders[i]) return "some of the last levels differ by rounding only";
    if (*orders[i] <= 0.0) return fmt::format("the differences do not shrink (order {:.2g})", *orders[i]);
    if (*orders[i] > largest_credible)
      return fmt::format("the order {:.3g} is not credible: it is more than twice the formal order {:g}", *orders[i],
                         formal);
  }
  return "";
}

/// The levels that count: the finest consecutive levels that have a result and the outcome of the finest level.
struct CountedLevels {
  std::size_t first = 0;  ///< index of the first level that counts
  std::vector<double> f;  ///< results of the levels that count, coarsest first
  double largest = 0.0;   ///< largest magnitude of the results

  std::size_t count() const { return f.size(); }
  bool is_rounding(double difference) const { return std::abs(difference) <= kRoundingShare * largest; }
};

/// Returns the levels that count.
CountedLevels counted_levels(std::span<const LevelResult> levels) {
  CountedLevels counted;
  std::size_t first = levels.size();
  while (first > 0 && levels[first - 1].result && levels[first - 1].outcome == levels.back().outcome) --first;
  counted.first = first;
  for (const LevelResult& level : levels.subspan(first)) {
    counted.f.push_back(*level.result);
    counted.largest = std::max(counted.largest, std::abs(counted.f.back()));
  }
  return counted;
}

/// Writes to `c` the observed order of each level, from its result and the results of the two next coarser levels.
void add_orders(const LevelSweep& sweep, const CountedLevels& counted, Convergence& c) {
  const std::vector<double>& f = counted.f;
  for (std::size_t i = 2; i < f.size(); ++i) {
    const double coarse = f[i - 2] - f[i - 1], fine = f[i - 1] - f[i];
    if (counted.is_rounding(coarse) || counted.is_rounding(fine) || !(coarse * fine > 0.0)) continue;
    c.orders[counted.first + i] = math::log(coarse / fine) / math::log(sweep.ratio);
  }
}

/// Writes to `c` the band of the last levels, and the error estimates for the case without an order. `spread`: sampling
/// spread of a metric that is not smooth.
void add_band(const LevelSweep& sweep, const CountedLevels& counted, const MetricTraits& traits, double spread,
              Convergence& c) {
  const std::vector<double>& f = counted.f;
  if (f.size() < 2) return;
  const auto last = f.end() - static_cast<std::ptrdiff_t>(std::min(f.size(), kMinLevels));
  c.band = {*std::min_element(last, f.end()), *std::max_element(last, f.end())};
  const double width = c.band->second - c.band->first;
  // At first order, all further refinements together change the result by the last difference divided by r - 1.
  const double rest = std::abs(f[f.size() - 1] - f[f.size() - 2]) / std::min(1.0, sweep.ratio - 1.0);
  const double beyond = traits.smooth ? 0.0 : rest + spread;
  for (std::size_t i = 0; i < f.size(); ++i) {
    double error = width;
    for (std::size_t j = i + 1; j < f.size(); ++j) error = std::max(error, std::abs(f[i] - f[j]));
    c.errors[counted.first + i] = error + beyond;
  }
  if (!traits.smooth) c.band = {c.band->first - spread, c.band->second + spread};
}

/// Returns Richardson's extrapolated value of the results `f`, which converge with order `p`.
double extrapolated_value(const LevelSweep& sweep, std::span<const double> f, double p) {
  return f[f.size() - 1] + (f[f.size() - 1] - f[f.size() - 2]) / (math::pow(sweep.ratio, p) - 1.0);
}

/// Returns a text that explains why no order can be stated; empty if an order can be stated.
std::string no_order_reason(const LevelSweep& sweep, std::span<const LevelResult> levels, const CountedLevels& counted,
                            std::span<const std::optional<double>> orders, const MetricTraits& traits) {
  const auto is_first = [&](const LevelResult& level) { return level.state_hash == levels.front().state_hash; };
  if (levels.size() > 1 && levels.back().result && std::ranges::all_of(levels, is_first))
    return fmt::format("{} has no effect here: the runs of all levels are identical", sweep.axis.path);
  if (!sweep.no_order.empty()) return sweep.no_order;
  const std::vector<double>& f = counted.f;
  if (f.size() < min_levels(traits)) return too_few_reason(levels, counted.first, traits);
  if (counted.is_rounding(f[f.size() - 2] - f.back())) return "the last levels differ by rounding only";
  if (std::string reason = switching_reason(levels.last(min_levels(traits))); !reason.empty()) return reason;
  const std::size_t count = traits.smooth ? kMinLevels + 1 : kMinLevelsOfEvents;
  std::string reason = incredible_reason(f, orders.subspan(counted.first), count, sweep.formal_order, sweep.ratio);
  if (!reason.empty() || traits.either_sign) return reason;
  const double extrapolated = extrapolated_value(sweep, f, *orders.back());
  if (extrapolated >= -kRoundingShare * counted.largest) return "";
  return fmt::format("the extrapolated value {:.3g} is negative, which this metric cannot be", extrapolated);
}

/// Writes to `c` the quantities that follow from the observed order: Richardson's value, the GCI and the error
/// estimates of all levels. Precondition: the last level has an order.
void add_extrapolation(const LevelSweep& sweep, const CountedLevels& counted, const MetricTraits& traits, double spread,
                       Convergence& c) {
  const std::vector<double>& f = counted.f;
  const std::size_t count = f.size();
  const double p = *c.orders.back(), growth = math::pow(sweep.ratio, p), fine = f[count - 1] - f[count - 2];
  c.order = p;
  c.extrapolated = extrapolated_value(sweep, f, p);
  if (f[count - 1] != 0.0) c.gci = kGciSafety * std::abs(fine) / (std::abs(f[count - 1]) * (growth - 1.0));
  const double scatter = traits.smooth ? 0.0 : c.band->second - c.band->first - 2.0 * spread;
  for (std::size_t i = 0; i < count; ++i) {
    const double error = std::max(kGciSafety * std::abs(f[i] - *c.extrapolated), scatter);
    c.errors[counted.first + i] = error + (traits.smooth ? 0.0 : spread);
  }
  const auto in_range = [&](std::size_t i) {  // asymptotic range of the levels i - 2, i - 1 and i
    const double gci_21 = (f[i - 1] - f[i - 2]) / std::abs(f[i - 1]), gci_32 = (f[i] - f[i - 1]) / std::abs(f[i]);
    return std::abs(gci_21 / (growth * gci_32) - 1.0) <= kAsymptoticWithin;
  };
  c.asymptotic = in_range(count - 1) && (count == kMinLevels || in_range(count - 2));
}

}  // namespace

Convergence convergence_of(const LevelSweep& sweep, std::span<const LevelResult> levels, const MetricTraits& traits) {
  Convergence c;
  c.orders.resize(levels.size());
  c.errors.resize(levels.size());
  const CountedLevels counted = counted_levels(levels);
  add_orders(sweep, counted, c);
  const double spread = levels.empty() ? 0.0 : levels.back().spread;
  add_band(sweep, counted, traits, spread, c);
  c.reason = no_order_reason(sweep, levels, counted, c.orders, traits);
  if (c.reason.empty()) add_extrapolation(sweep, counted, traits, spread, c);
  return c;
}

MetricTraits traits_of(const MetricList& list, const std::string& metric) {
  const Metric* found = find_metric(list, metric);
  if (found == nullptr) return {.smooth = false, .either_sign = false};
  return {found->smooth, found->either_sign};
}

LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary,
                         const std::string& metric) {
  // Contact counts that detect switching contacts. If the point spacing is refined, the surface has other points, and
  // only the number of landings is comparable.
  constexpr const char* kContactCounts[] = {"landings", "steps_in_contact", "colliding_mean", "rendered_mean"};
  const std::string& path = levels.axis.path;
  LevelResult result{.setting = fmt::format("{} = {}", path, level_text(levels, level)),
                     .outcome = std::string(outcome_name(summary.end.outcome)),
                     .result = std::nullopt,
                     .state_hash = summary.state_hash};
  if (summary.end.outcome != Outcome::diverges) result.result = number_of(summary.metrics, metric);
  if (const Metric* found = find_metric(summary.metrics, metric)) result.spread = found->sampling_spread;
  const std::span<const char* const> counts = kContactCounts;
  for (const char* name : counts.first(path.starts_with("environment.") ? 1 : counts.size()))
    result.contacts.emplace_back(name, number_of(summary.metrics, name).value_or(0.0));
  return result;
}

}  // namespace hapbench
