#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <span>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/cases/comparison.hpp"
#include "scenarios/limits/convergence/convergence.hpp"
#include "scenarios/limits/tuning/trials.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/core/math.hpp"

/// Checks a choice before it is recommended: between the values tried, in longer runs and up to its margins. If nothing
/// is feasible, explains what is in the way and what to relax.
namespace hapbench {
namespace {

constexpr double kMuchLess = 1.25;  // of K, that is given up where a choice does not hold for longer

using Strained = std::function<Strain(double value)>;  ///< at a value of a way

const Strained kByGain = [](double gain) { return Strain{gain}; };

/// A part of a way at which a run is not settled, and why.
struct Failing {
  double part;
  std::string why;
};

/// The first of these parts, the family taking turns.
std::optional<Failing> first_failing(Trials& trials, const TuneTrial& trial, const SearchWay& way,
                                     std::span<const double> parts, const Strained& strained) {
  std::vector<std::string> why(parts.size());
  trials.in_parallel(parts.size(), [&](std::size_t i) {
    why[i] = trials.unsettled(trial, trials.family[i % trials.family.size()], strained(way.value_at(parts[i])));
  });
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (!why[i].empty()) return Failing{parts[i], why[i]};
  return std::nullopt;
}

/// Nothing is tried any more that reaches K, which is not settled, within its margin.
bool refute(Trials& trials, const TuneTrial& choice, double K, const std::string& why) {
  trials.refuted = std::min(trials.refuted, K);
  trials.cap = K / trials.question.margin * (1.0 - kTuneResolution);
  trials.end.fail("margin", fmt::format("at {:.4g} N/m{} {}", K, setting_text(choice), why));
  return true;
}

bool fails_between(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const SearchWay gains{.range = {1.0, trials.question.margin, true}};
  std::vector<double> parts = parts_between(0.0, 1.0, kTriedBetween);
  const std::vector<double> near = parts_between(1.0, 1.0 - near_part(gains, 1.0), kTriedNear);
  parts.insert(parts.end(), near.begin(), near.end());
  if (const auto failing = first_failing(trials, choice, gains, parts, kByGain))
    return refute(trials, choice, choice.stiffness * gains.value_at(failing->part), failing->why);
  law.verified = parts.size();
  return false;
}

/// Finds the edges of K in the scene as chosen; true where the own run has one before G K.
bool own_edge_is_near(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const ScenarioText& scene = trials.question.scenario;
  const std::vector<std::string> chosen = trials.overrides(choice, choice.stiffness);
  LimitQuestion question = limit_question(scene, chosen, kTunedField, {});
  static_cast<StabilityRule&>(question) = rule_of(load_scenario(scene, chosen).scenario);
  question.threads = trials.question.threads;
  law.edge = field_limit(question);
  trials.runs += law.edge.runs.size();
  const double G_K = trials.question.margin * choice.stiffness;
  if (!law.edge.value) return refute(trials, choice, G_K, "stable values are scattered");
  if (!law.edge.beyond) return false;
  const auto& [K, verdict] = *law.edge.beyond;
  if (K < G_K) return refute(trials, choice, K, std::string(run_verdict_name(verdict)));
  trials.refuted = std::min(trials.refuted, K);
  return false;
}

bool fails_later(Trials& trials, const TuneTrial& choice) {
  const Scenario own = trials.load(choice, choice.stiffness, trials.family[0]).scenario;
  const double duration = own.time.step * static_cast<double>(own.time.steps);
  // A script that leads on comes to places that the scene does not ask for.
  if (script_moves_until(own) > duration && script_period(own) == 0.0) return false;
  const std::string why = trials.unsettled(choice, {1.0, fmt::format("time.steps={}", 2 * own.time.steps)});
  if (why.empty()) return false;
  trials.cap = choice.stiffness / kMuchLess;
  trials.end.fail(
      "settled", fmt::format("at {:.4g} N/m{} in a run twice as long {}", choice.stiffness, setting_text(choice), why));
  return true;
}

/// TunedLaw::error of a trial.
TuneMetrics known_errors(Trials& trials, const TuneTrial& trial) {
  const ScenarioText& scene = trials.question.scenario;
  const std::vector<std::string> chosen = trials.overrides(trial, trial.stiffness);
  const LoadedScenario own = load_scenario(scene, chosen);
  const Cases once({scene}, chosen, std::vector<Axis>{});
  std::vector<Cases> finer = {finer_cases(level_sweep(own, kStepPath, 2, 2.0), once)};
  if (const auto distance = point_distance(own)) {
    finer.push_back(finer_cases(level_sweep(own, distance->path, 2, 2.0), once));
    finer.emplace_back(std::vector{scene}, chosen, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  trials.runs += finer.size();
  std::vector<TuneMetrics> all;
  for (const Result& run : run_all(finer, {trials.question.threads, ""})) all.push_back(trials.metrics_of(run));
  TuneMetrics error;
  for (const auto& [name, value] : trial.metrics) {
    double most = 0.0;
    for (const TuneMetrics& metrics : all) {
      const auto found = metrics.find(name);
      most = std::max(
          most, found == metrics.end() ? std::numeric_limits<double>::infinity() : std::abs(found->second - value));
    }
    if (std::isfinite(most)) error[name] = most;
  }
  return error;
}

/// True where a limit of the user is not kept by as much as the metric's error. Then less is allowed.
bool is_beyond_limits(Trials& trials, TuneTrial& choice, TunedLaw& law) {
  trials.measure(choice);
  law.error = trials.error = known_errors(trials, choice);
  bool beyond = false;
  for (const auto& [name, bound] : trials.question.limits) {
    const auto worst = choice.worst.find(name), error = law.error.find(name);
    if (worst == choice.worst.end() || error == law.error.end()) continue;
    MetricBound& allowed = trials.limits[name];
    if (bound.max && worst->second + error->second > *bound.max) {
      allowed.max = std::min(*allowed.max * (1.0 - kTuneResolution), std::max(*bound.max - error->second, 0.0));
      beyond = true;
    }
    if (bound.min && worst->second - error->second < *bound.min) {
      allowed.min = *bound.min + error->second;
      beyond = true;
    }
  }
  for (auto& [key, trial] : trials.all)
    if (beyond && (trial.limits_alone || trial.feasible())) trials.judge_worst(trial);
  return beyond;
}

/// kTriedBetween parts before the last, of delays also each quarter of a sample; of whole numbers all.
std::vector<double> parts_up_to(const SearchWay& way, double last) {
  std::vector<double> parts;
  if (!way.whole) parts = parts_between(0.0, last, kTriedBetween);
  const double step = way.range.logarithmic ? 1.0 : (way.whole ? 1.0 : 0.25) / (way.range.to - way.range.from);
  for (double part = step; part < last; part += step) parts.push_back(part);
  return parts;
}

/// The last value of a way up to which the trial is settled, also at values between.
double last_settled(Trials& trials, const TuneTrial& trial, const SearchWay& way, const Strained& strained) {
  const auto holds = [&](double part) { return trials.unsettled(trial, strained(way.value_at(part))).empty(); };
  bool so_far = true;  // a run beyond the first edge tells nothing
  std::map<double, bool> tried = scanned(kEdgeIntervals, [&](double part) { return so_far = so_far && holds(part); });
  while (true) {
    const double last = find_edge(way, tried, holds, false).stable.value_or(0.0);
    const auto failing = first_failing(trials, trial, way, parts_up_to(way, last), strained);
    if (!failing) return way.value_at(last);
    tried[failing->part] = false;
  }
}

/// The damping ratio of the least damped mode of the loop in contact; empty where there is no loop.
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

// ---- Nothing feasible

std::string then_text(const TuneTrial& trial) {
  return fmt::format("then K = {:.4g} N/m{}", trial.stiffness, setting_text(trial));
}

/// How far a limit has to give way to a trial: what the user asked for, or what is quiet.
std::string relaxed(const Trials& trials, const TuneTrial& trial, const std::string& name) {
  const auto worst = trial.worst.find(name);
  if (worst == trial.worst.end()) return fmt::format("drop the limit on {}, which has no value here", name);
  const auto error = trials.error.find(name), none = trials.error.end();
  const double more = error == none ? 0.0 : error->second;
  const auto asked = trials.question.limits.find(name);
  const MetricBound& bound = asked == trials.question.limits.end() ? trials.limits.at(name) : asked->second;
  if (bound.max)
    return fmt::format("{} <= {:.3g} in place of {:.3g}", name, (worst->second + more) * 1.001, *bound.max);
  return fmt::format("{} >= {:.3g} in place of {:.3g}", name, (worst->second - more) * 0.999, bound.min.value_or(0.0));
}

/// For each limit the least by which it alone has to give way for a trial to keep all; where one is not enough, what
/// the nearest trial needs.
std::string relaxations(const Trials& trials, const TuneTrial& nearest) {
  std::vector<std::string> texts;
  for (const auto& [name, bound] : trials.limits) {
    const TuneTrial* least = nullptr;
    for (const auto& [key, trial] : trials.all) {
      if (!trial.limits_alone || trials.excess(trial).first != 1) continue;
      const double times = trials.times_limit(trial, name, bound);
      if (times > 1.0 && (least == nullptr || times < trials.times_limit(*least, name, bound))) least = &trial;
    }
    if (least != nullptr) texts.push_back(relaxed(trials, *least, name) + "; " + then_text(*least));
  }
  if (!texts.empty()) return fmt::format("{}", fmt::join(texts, "; or "));
  for (const auto& [name, bound] : trials.limits)
    if (trials.times_limit(nearest, name, bound) > 1.0) texts.push_back(relaxed(trials, nearest, name));
  return fmt::format("{}; {}", fmt::join(texts, "; "), then_text(nearest));
}

void explain_limits(Trials& trials, const TuneTrial& nearest, TunedLaw& law) {
  if (!trials.is_quiet) trials.error = known_errors(trials, nearest);
  law.binding = nearest.binding;
  law.why = nearest.why;
  if (const auto error = trials.error.find(law.binding); error != trials.error.end() && error->second > 0.0)
    law.why += fmt::format(" +- {:.2g}", error->second);
  law.relax = relaxations(trials, nearest);
  if (trials.is_quiet)
    law.relax += "; a limit of your own, such as --bound force_rms_above_30Hz_N=0.05, takes the place of what is quiet";
}

/// Where no limit is in the way: a trial that lacks the margin alone, or else the last one.
void explain_motion(const Trials& trials, TunedLaw& law) {
  const auto lacks_margin = [](const auto& tried) { return tried.second.binding == "margin"; };
  const auto found = std::ranges::find_if(trials.all, lacks_margin);
  const TuneTrial& trial = found != trials.all.end() ? found->second : trials.all.rbegin()->second;
  law.binding = trial.binding;
  law.why = trial.why;
  law.relax = law.binding == "margin" ? "a smaller --margin; else" : "no limit is to blame:";
  law.relax += " a gentler hand, a wider tool or another device, or other runs with --family";
}

}  // namespace

bool is_refuted(Trials& trials, TuneTrial& choice, TunedLaw& law) {
  return fails_between(trials, choice, law) || own_edge_is_near(trials, choice, law) || fails_later(trials, choice) ||
         is_beyond_limits(trials, choice, law);
}

TuneMargins margins_of(Trials& trials, const TuneTrial& choice) {
  TuneMargins margins;
  const double G = trials.question.margin, largest = trials.ranges.stiffness.to,
               most = std::min(largest, trials.refuted) / choice.stiffness;
  if (most > G * (1.0 + kTuneResolution))
    margins.gain = last_settled(
        trials, choice, {.range = {G, std::min(kMostGain, most), true}, .resolution = kTuneResolution}, kByGain);
  else if (trials.refuted < largest)
    margins.gain = G;
  const Scenario scenario = trials.load(choice, choice.stiffness, trials.family[0]).scenario;
  if (has_device(scenario)) {
    const bool whole = std::holds_alternative<AdmittanceDeviceConfig>(scenario.device);
    const SearchWay delays{.range = {0.0, kMostDelay}, .whole = whole, .resolution = 0.02 / kMostDelay};
    margins.delay_samples = last_settled(trials, choice, delays, [&](double more) {
      return Strain{1.0, fmt::format("{}={}", delay_path(scenario), delay_of(scenario) + more)};
    });
  }
  const double lambda = trials.springs_lambda.value_or(choice.lambda_max);
  margins.damping_ratio = least_damping_ratio(scenario, lambda, trials.over_hands);
  return margins;
}

void explain(Trials& trials, TunedLaw& law) {
  if (const TuneTrial* nearest = trials.nearest()) return explain_limits(trials, *nearest, law);
  explain_motion(trials, law);
}

}  // namespace hapbench
