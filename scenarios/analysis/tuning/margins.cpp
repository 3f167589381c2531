#include "scenarios/analysis/tuning/margins.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/verification.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

/// Returns the parameters between 0 and `last` at which an interval is verified. Logarithmic range:
/// kVerificationSamples parameters. Range of integers: every integer. Other ranges, whose values are delays:
/// kVerificationSamples parameters, and every quarter of a time step.
std::vector<double> parameters_up_to(const IntervalSearchOptions& options, double last) {
  std::vector<double> parameters;
  if (!options.whole) parameters = parameters_between(0.0, last, kVerificationSamples);
  if (options.range.logarithmic) return parameters;
  const double samples = options.whole ? 1.0 : 0.25;
  const double step = samples / (options.range.to - options.range.from);
  for (double t = step; t < last; t += step) parameters.push_back(t);
  return parameters;
}

/// Returns the largest value of a range up to which all variants of the trial are settled. `override_of`: returns the
/// override that sets a value. Verifies the interval at the parameters of parameters_up_to(); a parameter that fails
/// shortens the interval.
double last_settled(Trials& trials, const TuneTrial& trial, const IntervalSearchOptions& options,
                    const std::function<std::string(double value)>& override_of) {
  const auto holds = [&](double t) {
    const auto override_at = [&](std::size_t) { return override_of(options.value_at(t)); };
    return !trials.first_failing(trial, trials.variant_count(), override_at);
  };
  bool so_far = true;  // false after the first failure; larger values do not change the result and are not run
  const auto holds_so_far = [&](double t) {
    so_far = so_far && holds(t);
    return so_far;
  };
  // Search for the largest settled value, and verify the values below it. If one of these values fails, search again
  // below the failed value.
  EvaluatedParameters evaluated = evaluate_scan(kScanIntervals, holds_so_far);
  while (true) {
    const double last = find_stable_interval(options, evaluated, holds, false).stable.value_or(0.0);
    const std::vector<double> parameters = parameters_up_to(options, last);
    const auto override_at = [&](std::size_t i) { return override_of(options.value_at(parameters[i])); };
    const auto failing = trials.first_failing(trial, parameters.size(), override_at);
    if (!failing) return options.value_at(last);
    evaluated[parameters[failing->run]] = false;
  }
}

/// Returns the damping ratio of the mode with the eigenvalue z of the linear map of one time step. Empty if the mode is
/// a state of a delay line, or the free motion of a tool in some direction.
std::optional<double> damping_ratio(const std::complex<double>& z) {
  // Largest |z| of a delay-line state; largest |z - 1| of a freely moving tool, as in is_stable_loop().
  constexpr double kDelayLine = 1e-9, kFree = 1e-5;
  const double magnitude = math::hypot(z.real(), z.imag()), decay = -math::log(std::max(magnitude, kDelayLine));
  if (magnitude < kDelayLine || std::norm(z - 1.0) < kFree * kFree || decay == 0.0) return std::nullopt;
  return decay / math::hypot(decay, math::atan2(z.imag(), z.real()));
}

/// Returns the damping ratio of the least damped mode of the loops in contact; empty without loops.
std::optional<double> smallest_damping_ratio(const std::vector<NamedLoop>& loops) {
  std::optional<double> smallest;
  for (const NamedLoop& loop : loops)
    for (const Eigen::MatrixXd& step : loop.matrices)
      for (const std::complex<double>& z : eigenvalues(step))
        if (const auto ratio = damping_ratio(z)) smallest = std::min(smallest.value_or(1.0), *ratio);
  return smallest;
}

/// Returns the largest factor on K up to which all variants of the choice are settled. Returns the required margin G if
/// a K just above G K is known to be unstable. Otherwise, if the range of K ends at G K, returns an empty value.
std::optional<double> gain_margin(Trials& trials, const TuneTrial& choice) {
  const double G = trials.question().margin, largest = trials.ranges().stiffness.to;
  const double largest_gain = std::min(largest, trials.smallest_unstable()) / choice.stiffness;
  if (largest_gain > G * (1.0 + kTuneResolution)) {
    const IntervalSearchOptions gains{.range = {G, std::min(kMaxGainMargin, largest_gain), true},
                                      .resolution = kTuneResolution};
    return last_settled(trials, choice, gains, [&](double gain) { return with_gain(choice, gain); });
  }
  return trials.smallest_unstable() < largest ? std::optional(G) : std::nullopt;
}

/// Returns the largest additional delay [samples] up to which all variants of the choice are settled; empty for an
/// ideal device.
std::optional<double> delay_margin(Trials& trials, const TuneTrial& choice, const Scenario& scenario) {
  if (!has_device(scenario)) return std::nullopt;
  const bool whole = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
  const IntervalSearchOptions delays{
      .range = {0.0, kMaxDelayMargin}, .whole = whole, .resolution = 0.02 / kMaxDelayMargin};
  return last_settled(trials, choice, delays, [&](double more) {
    return fmt::format("{}={}", delay_path(scenario), delay_of(scenario) + more);
  });
}

}  // namespace

TuneMargins margins_of(Trials& trials, const TuneTrial& choice) {
  TuneMargins margins;
  margins.gain = gain_margin(trials, choice);
  const Scenario scenario = trials.trial_runs().load(choice.setting, choice.stiffness).scenario;
  margins.delay_samples = delay_margin(trials, choice, scenario);
  margins.damping_ratio = smallest_damping_ratio(
      trials.trial_runs().loops_in_contact(scenario, choice.contact, trials.trial_runs().over_hands()));
  return margins;
}

}  // namespace hapbench
