#include "scenarios/analysis/tuning/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenarios/analysis/convergence/levels.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/batch/run_all.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/run/scripted_motion.hpp"

namespace hapbench {
namespace {

constexpr double kStiffnessReduction = 1.25;  // K is divided by this if a longer run is not settled

/// Records that the run at K is not settled. Limits the search to stiffnesses K' with G K' below K. Returns true.
bool refute(Trials& trials, const TuneTrial& choice, double K, const std::string& why) {
  trials.note_unstable(K);
  trials.set_cap(K / trials.question().margin * (1.0 - kTuneResolution), "margin",
                 fmt::format("at {:.4g} N/m{}: {}", K, setting_text(choice.setting), why));
  return true;
}

/// Returns true if a run at a gain between 1 and G, or just below G, is not settled.
bool fails_between(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const IntervalSearchOptions gains{.range = {1.0, trials.question().margin, true}};
  std::vector<double> parameters = parameters_between(0.0, 1.0, kVerificationSamples);
  const std::vector<double> near = parameters_below(gains, 1.0);
  parameters.insert(parameters.end(), near.begin(), near.end());
  const auto override_at = [&](std::size_t i) { return with_gain(choice, gains.value_at(parameters[i])); };
  if (const auto failing = trials.first_failing(choice, parameters.size(), override_at))
    return refute(trials, choice, choice.stiffness * gains.value_at(parameters[failing->run]), failing->why);
  law.verified = parameters.size();
  return false;
}

/// Finds the stability limits of K in the scene with the choice. Returns true if there is a limit below G K.
bool scene_limit_is_near(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const ScenarioText& scene = trials.question().scenario;
  const std::vector<std::string> chosen = trials.overrides(choice.setting, choice.stiffness);
  LimitQuestion question = limit_question(scene, chosen, kStiffnessPath, {});
  question.rule = rule_of(load_scenario(scene, chosen).scenario);
  question.threads = trials.question().threads;
  law.edge = field_limit(question);
  trials.count_runs(law.edge.runs.size());
  const double G_K = trials.question().margin * choice.stiffness;
  // Reject a choice without a contiguous stable interval, or with a limit below G K.
  if (!law.edge.end.value) return refute(trials, choice, G_K, "stable and unstable values alternate");
  if (!law.edge.end.beyond) return false;
  const auto& [K, verdict] = *law.edge.end.beyond;
  if (K < G_K) return refute(trials, choice, K, std::string(run_verdict_name(verdict)));
  trials.note_unstable(K);
  return false;
}

/// Returns true if a run twice as long is not settled, in any variant.
bool fails_in_longer_run(Trials& trials, const TuneTrial& choice) {
  const Scenario scenario = trials.load(choice.setting, choice.stiffness).scenario;
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  // Skip this verification if a script goes on after the end of the scene, because it would move the tool to other
  // positions.
  if (script_moves_until(scenario) > duration && script_period(scenario) == 0.0) return false;
  const auto twice = [&](std::size_t) { return fmt::format("time.steps={}", 2 * scenario.time.steps); };
  const auto failing = trials.first_failing(choice, trials.variant_count(), twice);
  if (!failing) return false;
  trials.set_cap(choice.stiffness / kStiffnessReduction, "settled",
                 fmt::format("at {:.4g} N/m{}, in a run twice as long: {}", choice.stiffness,
                             setting_text(choice.setting), failing->why));
  return true;
}

/// Returns true if a limit of the user is violated within the metric's error. Then tightens the limits.
bool is_beyond_limits(Trials& trials, TuneTrial& choice, TunedLaw& law) {
  trials.measure(choice);
  law.error = known_errors(trials, choice);
  trials.set_error(law.error);
  return trials.tighten_limits(choice);
}

}  // namespace

std::string with_gain(const TuneTrial& trial, double gain) {
  return fmt::format("{}={}", kStiffnessPath, gain * trial.stiffness);
}

TuneMetrics known_errors(Trials& trials, const TuneTrial& trial) {
  const ScenarioText& scene = trials.question().scenario;
  const std::vector<std::string> chosen = trials.overrides(trial.setting, trial.stiffness);
  const LoadedScenario scenario = load_scenario(scene, chosen);
  const Cases once({scene}, chosen, std::vector<Axis>{});
  std::vector<Cases> finer = {finer_cases(level_sweep(scenario, kStepPath, 2, 2.0), once)};
  if (const auto distance = point_distance(scenario)) {
    finer.push_back(finer_cases(level_sweep(scenario, distance->path, 2, 2.0), once));
    finer.emplace_back(std::vector{scene}, chosen, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  trials.count_runs(finer.size());
  const std::vector<Result> runs = run_all(finer, {trials.question().threads, ""});
  // The error of a metric is its largest change. A metric that is missing in one of the runs has no error estimate.
  TuneMetrics error;
  for (const auto& [name, value] : trial.metrics) {
    double largest = 0.0;
    for (const Result& run : runs) {
      const double moved = number_of(run.metrics, name).value_or(std::numeric_limits<double>::infinity());
      largest = std::max(largest, std::abs(moved - value));
    }
    if (std::isfinite(largest)) error[name] = largest;
  }
  return error;
}

bool is_verified(Trials& trials, TuneTrial& choice, TunedLaw& law) {
  return !fails_between(trials, choice, law) && !scene_limit_is_near(trials, choice, law) &&
         !fails_in_longer_run(trials, choice) && !is_beyond_limits(trials, choice, law);
}

}  // namespace hapbench
