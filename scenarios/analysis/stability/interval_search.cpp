#include "scenarios/analysis/stability/interval_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

bool is_stable_entry(const EvaluatedParameters::value_type& evaluated) {
  return evaluated.second;
}

bool is_unstable_entry(const EvaluatedParameters::value_type& evaluated) {
  return !evaluated.second;
}

/// Implements find_stable_interval().
class TransitionSearch {
 public:
  TransitionSearch(const IntervalSearchOptions& options, EvaluatedParameters& evaluated, const IsStable& stable)
      : options_(options), evaluated_(evaluated), stable_(stable) {}

  /// Returns the first stable-to-unstable transition, without evaluating samples beside the transition. Sets only
  /// `stable` and `beyond` of the result.
  StableInterval first() {
    start();
    const std::optional<Transition> transition = next_transition();
    return transition ? bisected_transition(*transition) : StableInterval{};
  }

  /// Returns the first stable-to-unstable transition that samples on both sides confirm, and the other end of the
  /// stable interval below the transition.
  StableInterval confirmed() {
    // Maximum number of bisected transitions. The samples beside a transition may reveal an earlier transition.
    constexpr int kMaxRounds = 6;
    start();
    StableInterval interval;
    for (int round = 0; round < kMaxRounds; ++round) {
      const std::optional<Transition> transition = next_transition();
      if (!transition) return {};
      const bool is_confirmed = transition->high && interval.stable == transition->low;
      if (is_confirmed) break;
      interval = bisected_transition(*transition);
      if (!interval.beyond) break;
      evaluate_beside(transition->first_stable, interval);
    }
    add_other_end(interval);
    return interval;
  }

 private:
  /// A contiguous group of stable parameters, and the unstable parameter above the group.
  struct Transition {
    double first_stable;         ///< smallest stable parameter of the group
    double low;                  ///< largest stable parameter of the group
    std::optional<double> high;  ///< next larger parameter, which is unstable; empty if t = 1 is stable
  };

  bool evaluate(double t) {
    const bool is_stable = stable_(t);
    evaluated_[t] = is_stable;
    return is_stable;
  }

  /// Sets the start of the search: the current value, or t = 0 if the current value is unstable.
  void start() {
    const std::optional<double> current = options_.current_parameter();
    start_ = current && evaluate(*current) ? *current : 0.0;
  }

  /// Returns the first group of stable parameters at or above the start; empty if there is no such group.
  std::optional<Transition> next_transition() const {
    const auto first = std::find_if(evaluated_.lower_bound(start_), evaluated_.end(), is_stable_entry);
    if (first == evaluated_.end()) return std::nullopt;
    const auto end = std::find_if(first, evaluated_.end(), is_unstable_entry);
    Transition transition{first->first, std::prev(end)->first, std::nullopt};
    if (end != evaluated_.end()) transition.high = end->first;
    return transition;
  }

  StableInterval bisected_transition(const Transition& transition) {
    if (!transition.high) return {.stable = transition.low};
    const auto [stable, unstable] = bisected(transition.low, *transition.high);
    return {.stable = stable, .beyond = unstable};
  }

  /// Bisects between a stable and an unstable parameter down to the resolution. Returns the final stable and unstable
  /// parameter.
  std::pair<double, double> bisected(double stable, double unstable) {
    while (options_.needs_bisection(stable, unstable)) {
      const double middle = 0.5 * (stable + unstable);
      if (evaluate(middle))
        stable = middle;
      else
        unstable = middle;
    }
    return {stable, unstable};
  }

  /// Evaluates three parameters on each side of a transition, at most the length of one scan interval away from the
  /// transition.
  void evaluate_beside(double first_stable, const StableInterval& interval) {
    constexpr int kBeside = 3;  // number of samples on each side
    constexpr double kInterval = 1.0 / kScanIntervals;
    const double before = std::max(first_stable, *interval.stable - kInterval);
    const double behind = std::min(1.0, *interval.beyond + kInterval);
    for (int i = 1; i <= kBeside; ++i) {
      const double fraction = static_cast<double>(i) / (kBeside + 1);
      evaluate(before + fraction * (*interval.stable - before));
      evaluate(*interval.beyond + fraction * (behind - *interval.beyond));
    }
  }

  /// Bisects the lower end of the interval of stable parameters.
  void add_other_end(StableInterval& interval) {
    auto first = evaluated_.find(*interval.stable);
    while (first != evaluated_.begin() && std::prev(first)->second) --first;
    interval.first = first->first;
    if (first == evaluated_.begin()) return;
    const auto [stable, unstable] = bisected(first->first, std::prev(first)->first);
    interval.first = stable;
    interval.before = unstable;
  }

  const IntervalSearchOptions& options_;
  EvaluatedParameters& evaluated_;
  const IsStable& stable_;
  double start_ = 0.0;
};

}  // namespace

double IntervalSearchOptions::value_at(double t) const {
  const double value = range.value_at(smallest ? 1.0 - t : t);
  return whole ? std::round(value) : value;
}

std::optional<double> IntervalSearchOptions::current_parameter() const {
  if (!current) return std::nullopt;
  const auto [from, to, logarithmic] = range;
  const double t = logarithmic ? math::log(*current / from) / math::log(to / from) : (*current - from) / (to - from);
  return smallest ? 1.0 - t : t;
}

bool IntervalSearchOptions::needs_bisection(double a, double b) const {
  const auto [low, high] = std::minmax({value_at(a), value_at(b)});
  if (whole) return high - low > 1.0;
  if (range.logarithmic) return high > (1.0 + resolution) * low;
  return high - low > resolution * (range.to - range.from);
}

std::vector<double> scan_parameters(int intervals) {
  std::vector<double> parameters;
  for (int i = 0; i <= intervals; ++i) parameters.push_back(static_cast<double>(i) / intervals);
  return parameters;
}

EvaluatedParameters evaluate_scan(int intervals, const IsStable& stable) {
  EvaluatedParameters evaluated;
  for (const double t : scan_parameters(intervals)) evaluated[t] = stable(t);
  return evaluated;
}

std::vector<double> scan_values(const IntervalSearchOptions& options, int intervals) {
  std::vector<double> values;
  for (const double t : scan_parameters(intervals)) values.push_back(options.value_at(t));
  return values;
}

StableInterval find_stable_interval(const IntervalSearchOptions& options, EvaluatedParameters& evaluated,
                                    const IsStable& stable, bool beside) {
  TransitionSearch search(options, evaluated, stable);
  return beside ? search.confirmed() : search.first();
}

double may_fail_share(std::size_t samples) {
  return 1.0 - math::pow(0.05, 1.0 / static_cast<double>(samples));
}

std::vector<double> parameters_between(double from, double to, std::size_t count) {
  constexpr double kGolden = std::numbers::phi - 1.0;
  std::vector<double> parameters;
  double fraction = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    fraction += kGolden;
    fraction -= std::floor(fraction);
    parameters.push_back(from + fraction * (to - from));
  }
  return parameters;
}

std::vector<double> parameters_below(const IntervalSearchOptions& options, double t) {
  const auto [from, to, logarithmic] = options.range;
  const double near = logarithmic
                          ? math::log(1.0 + kNearLimit) / math::log(to / from)
                          : kNearLimit * std::max(std::abs(options.value_at(t)) / (to - from), options.resolution);
  return parameters_between(t, std::max(0.0, t - near), kSamplesNearLimit);
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one search whose repetitions share the evaluated values.
StableInterval find_verified_interval(IntervalSearchOptions options, EvaluatedParameters& evaluated,
                                      const IsStable& stable, bool near,
                                      const std::function<void(std::span<const double>)>& ahead) {
  bool scattered = false, scattered_at_current = false;
  // Stable parameters up to this value are isolated samples, which the search treats as unstable.
  double scattered_up_to = -1.0;
  const auto counts_as_stable = [&](double t) { return t > scattered_up_to && stable(t); };
  // Evaluates the samples in order and adds them to `evaluated`. Stops at the first unstable sample and returns it.
  const auto first_failing = [&](const std::vector<double>& samples) -> std::optional<double> {
    ahead(samples);
    for (const double t : samples) {
      evaluated[t] = counts_as_stable(t);
      if (!evaluated[t]) return t;
    }
    return std::nullopt;
  };
  while (true) {
    StableInterval interval = find_stable_interval(options, evaluated, counts_as_stable, true);
    if (!interval.stable) return {.scattered = scattered};
    interval.scattered_at_current = scattered_at_current;
    const double first = interval.first.value_or(*interval.stable);
    // Verify the whole interval, then the neighbourhood of its limit.
    if (first_failing(parameters_between(first, *interval.stable, kVerificationSamples))) continue;
    if (!near || options.whole || !interval.beyond) return interval;
    const std::optional<double> failing = first_failing(parameters_below(options, *interval.stable));
    if (!failing) return interval;
    if (*failing > first) continue;
    // The unstable sample lies below the interval: the interval is shorter than kNearLimit times the limit.
    scattered = true;
    const std::optional<double> current = options.current_parameter();
    if (current && first <= *current && *current <= *interval.stable) {
      // The search began in this interval and has not seen the intervals below it. Search again from t = 0.
      scattered_at_current = true;
      options.current.reset();
      continue;
    }
    // Search above the interval.
    scattered_up_to = *interval.stable;
    for (auto& [t, is_stable] : evaluated) is_stable = is_stable && t > scattered_up_to;
  }
}

}  // namespace hapbench
