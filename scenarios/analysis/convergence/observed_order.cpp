#include "scenarios/analysis/convergence/observed_order.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "results/io/columns.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// A difference below this fraction of the results may be the rounding error of up to 10^6 steps. No order follows
/// from such differences.
constexpr double kRoundingShare = 1e-10;
constexpr double kGciSafety = 1.25;        // Roache's safety factor for three or more levels
constexpr double kAsymptoticWithin = 0.1;  // largest |GCI_21 / (r^p GCI_32) - 1|
constexpr std::size_t kMinLevels = 3;

/// Returns a text that explains why fewer than three levels count. `first`: index of the first level that counts.
std::string too_few_reason(std::span<const LevelResult> levels, std::size_t first) {
  const std::size_t count = levels.size() - first;
  if (first == 0) return fmt::format("three levels are needed, got {}", count);
  const LevelResult& last = levels[first - 1];
  const std::string why = fmt::format(
      fmt::runtime(last.result ? "has the outcome {}" : "has no value of the metric (outcome {})"), last.outcome);
  if (count == 0) return fmt::format("the finest run, at {}, {}", last.setting, why);
  return fmt::format("the run at {} {}, which leaves {} levels, and an order needs three", last.setting, why, count);
}

/// Returns a clause about the first contact count that differs between the levels; empty if none differs.
std::string switching_reason(std::span<const LevelResult> last) {
  for (std::size_t i = 0; i < last.front().contacts.size(); ++i) {
    const auto& [name, coarse] = last.front().contacts[i];
    for (const LevelResult& level : last.subspan(1)) {
      if (level.contacts[i].second == coarse) continue;
      return fmt::format("contacts change between the last levels ({} is {:.10g} at {}, {:.10g} at {})", name, coarse,
                         last.front().setting, level.contacts[i].second, level.setting);
    }
  }
  return "";
}

/// Returns a text that explains why the differences or orders of the last four (or three) results are not credible;
/// empty if they are credible. `f`: results, coarsest first. `most`: largest credible order.
std::string incredible_reason(std::span<const double> f, std::span<const std::optional<double>> orders, double most) {
  const std::size_t last = f.size() - 1, from = last >= 3 ? last - 3 : 0;
  for (std::size_t i = from + 2; i <= last; ++i) {
    const double coarse = f[i - 2] - f[i - 1], fine = f[i - 1] - f[i];
    if (coarse * fine < 0.0) return "the differences between the last levels change sign";
    if (!orders[i]) return "some of the last levels differ by rounding only";
    if (*orders[i] <= 0.0) return fmt::format("the differences do not shrink (order {:.2g})", *orders[i]);
    if (*orders[i] > most)
      return fmt::format("the order {:.3g} is not credible: it is more than twice the formal order {:g}", *orders[i],
                         most / 2);
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

/// Finds the levels that count.
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

/// Writes the observed order of each level, from its result and the results of the two next coarser levels.
void add_orders(const LevelSweep& sweep, const CountedLevels& counted, Convergence& c) {
  const std::vector<double>& f = counted.f;
  for (std::size_t i = 2; i < f.size(); ++i) {
    const double coarse = f[i - 2] - f[i - 1], fine = f[i - 1] - f[i];
    if (counted.is_rounding(coarse) || counted.is_rounding(fine) || !(coarse * fine > 0.0)) continue;
    c.orders[counted.first + i] = math::log(coarse / fine) / math::log(sweep.ratio);
  }
}

/// Writes the band of the last levels, and the error estimates that hold without an order.
void add_band(const CountedLevels& counted, Convergence& c) {
  const std::vector<double>& f = counted.f;
  if (f.size() < 2) return;
  const auto last = f.end() - static_cast<std::ptrdiff_t>(std::min(f.size(), kMinLevels));
  c.band = {*std::min_element(last, f.end()), *std::max_element(last, f.end())};
  for (std::size_t i = 0; i < f.size(); ++i) {
    double error = c.band->second - c.band->first;
    for (std::size_t j = i + 1; j < f.size(); ++j) error = std::max(error, std::abs(f[i] - f[j]));
    c.errors[counted.first + i] = error;
  }
}

/// Returns a text that explains why no order can be stated; empty if an order can be stated.
std::string no_order_reason(const LevelSweep& sweep, std::span<const LevelResult> levels, const CountedLevels& counted,
                            std::span<const std::optional<double>> orders) {
  const auto is_first = [&](const LevelResult& level) { return level.state_hash == levels.front().state_hash; };
  if (levels.size() > 1 && levels.back().result && std::ranges::all_of(levels, is_first))
    return fmt::format("{} has no effect here: the runs of all levels are identical", sweep.axis.path);
  if (!sweep.no_order.empty()) return sweep.no_order;
  const std::vector<double>& f = counted.f;
  if (f.size() < kMinLevels) return too_few_reason(levels, counted.first);
  if (counted.is_rounding(f[f.size() - 2] - f.back())) return "the last levels differ by rounding only";
  if (std::string reason = switching_reason(levels.last(kMinLevels)); !reason.empty()) return reason;
  return incredible_reason(f, orders.subspan(counted.first), 2.0 * sweep.formal_order);
}

/// Computes Richardson's value, the GCI and the error estimates of all levels from the observed order. Precondition:
/// the last level has an order.
void add_extrapolation(const LevelSweep& sweep, const CountedLevels& counted, Convergence& c) {
  const std::vector<double>& f = counted.f;
  const std::size_t count = f.size();
  const double p = *c.orders.back(), growth = math::pow(sweep.ratio, p), fine = f[count - 1] - f[count - 2];
  c.order = p;
  c.extrapolated = f[count - 1] + fine / (growth - 1.0);
  if (f[count - 1] != 0.0) c.gci = kGciSafety * std::abs(fine) / (std::abs(f[count - 1]) * (growth - 1.0));
  for (std::size_t i = 0; i < count; ++i) c.errors[counted.first + i] = kGciSafety * std::abs(f[i] - *c.extrapolated);
  const auto in_range = [&](std::size_t i) {  // asymptotic range of the levels i - 2, i - 1 and i
    const double gci_21 = (f[i - 1] - f[i - 2]) / std::abs(f[i - 1]), gci_32 = (f[i] - f[i - 1]) / std::abs(f[i]);
    return std::abs(gci_21 / (growth * gci_32) - 1.0) <= kAsymptoticWithin;
  };
  c.asymptotic = in_range(count - 1) && (count == kMinLevels || in_range(count - 2));
}

}  // namespace

Convergence convergence_of(const LevelSweep& sweep, std::span<const LevelResult> levels) {
  Convergence c;
  c.orders.resize(levels.size());
  c.errors.resize(levels.size());
  const CountedLevels counted = counted_levels(levels);
  add_orders(sweep, counted, c);
  add_band(counted, c);
  c.reason = no_order_reason(sweep, levels, counted, c.orders);
  if (c.reason.empty()) add_extrapolation(sweep, counted, c);
  return c;
}

LevelResult level_result(const LevelSweep& levels, std::size_t level, const Result& summary,
                         const std::string& metric) {
  // Contact counts that detect switching contacts. If the point spacing is refined, the surface has other points, and
  // only the number of landings is comparable.
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

}  // namespace hapbench
