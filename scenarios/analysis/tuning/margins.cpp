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

/// Returns verification samples below the parameter `last`: kTriedBetween of them, for delays also every quarter of a
/// sample, and for whole numbers all.
std::vector<double> parts_up_to(const SearchWay& way, double last) {
  std::vector<double> parts;
  if (!way.whole) parts = parts_between(0.0, last, kTriedBetween);
  if (way.range.logarithmic) return parts;
  const double samples = way.whole ? 1.0 : 0.25;
  const double step = samples / (way.range.to - way.range.from);
  for (double part = step; part < last; part += step) parts.push_back(part);
  return parts;
}

/// Returns the last value of a range up to which the trial is settled under its override, verified by samples between.
double last_settled(Trials& trials, const TuneTrial& trial, const SearchWay& way,
                    const std::function<std::string(double value)>& override_of) {
  const auto holds = [&](double part) {
    const auto with_part = [&](std::size_t) { return override_of(way.value_at(part)); };
    return !trials.first_failing(trial, trials.family_size(), with_part);
  };
  bool so_far = true;  // values beyond the first failure are not run: they do not change the answer
  const auto holds_so_far = [&](double part) {
    so_far = so_far && holds(part);
    return so_far;
  };
  TriedParts tried = scanned(kEdgeIntervals, holds_so_far);
  while (true) {
    const double last = find_edge(way, tried, holds, false).stable.value_or(0.0);
    const std::vector<double> parts = parts_up_to(way, last);
    const auto at_part = [&](std::size_t i) { return override_of(way.value_at(parts[i])); };
    const auto failing = trials.first_failing(trial, parts.size(), at_part);
    if (!failing) return way.value_at(last);
    tried[parts[failing->run]] = false;
  }
}

/// Returns the damping ratio of the least damped mode of the loop in contact; empty if there is no loop.
std::optional<double> least_damping_ratio(const Scenario& scenario, double lambda, bool over_hands) {
  std::optional<double> least;
  if (!(lambda > 0.0)) return least;
  for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands)) {
    for (const std::complex<double>& z : eigenvalues(step)) {
      const double size = math::hypot(z.real(), z.imag());
      if (size < 1e-9) continue;  // a delay line
      const double decay = -math::log(size), ratio = decay / math::hypot(decay, math::atan2(z.imag(), z.real()));
      if (decay != 0.0) least = std::min(least.value_or(1.0), ratio);
    }
  }
  return least;
}

/// Returns the largest factor on K; empty if no K beyond the margin can be run.
std::optional<double> gain_margin(Trials& trials, const TuneTrial& choice) {
  const double G = trials.question().margin, largest = trials.ranges().stiffness.to;
  const double most = std::min(largest, trials.refuted()) / choice.stiffness;
  if (most > G * (1.0 + kTuneResolution)) {
    const SearchWay gains{.range = {G, std::min(kMostGain, most), true}, .resolution = kTuneResolution};
    return last_settled(trials, choice, gains, [&](double gain) { return with_gain(choice, gain); });
  }
  return trials.refuted() < largest ? std::optional(G) : std::nullopt;
}

/// Returns the largest further delay; empty for an ideal device.
std::optional<double> delay_margin(Trials& trials, const TuneTrial& choice, const Scenario& scenario) {
  if (!has_device(scenario)) return std::nullopt;
  const bool whole = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
  const SearchWay delays{.range = {0.0, kMostDelay}, .whole = whole, .resolution = 0.02 / kMostDelay};
  return last_settled(trials, choice, delays, [&](double more) {
    return fmt::format("{}={}", delay_path(scenario), delay_of(scenario) + more);
  });
}

}  // namespace

TuneMargins margins_of(Trials& trials, const TuneTrial& choice) {
  TuneMargins margins;
  margins.gain = gain_margin(trials, choice);
  const Scenario scenario = trials.load(choice.setting, choice.stiffness).scenario;
  margins.delay_samples = delay_margin(trials, choice, scenario);
  margins.damping_ratio = least_damping_ratio(scenario, trials.lambda_of(choice), trials.over_hands());
  return margins;
}

}  // namespace hapbench
