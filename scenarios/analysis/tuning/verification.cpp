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

constexpr double kMuchLess = 1.25;  // factor by which K is reduced if a choice is not settled in a longer run

/// Lets nothing be tried any more that reaches K, which is not settled, within its margin. Returns true.
bool refute(Trials& trials, const TuneTrial& choice, double K, const std::string& why) {
  trials.note_unstable(K);
  trials.set_cap(K / trials.question().margin * (1.0 - kTuneResolution), "margin",
                 fmt::format("at {:.4g} N/m{}: {}", K, setting_text(choice.setting), why));
  return true;
}

/// Returns true if a run between the values that were tried, or just below G K, is not settled.
bool fails_between(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const SearchWay gains{.range = {1.0, trials.question().margin, true}};
  std::vector<double> parts = parts_between(0.0, 1.0, kTriedBetween);
  const std::vector<double> near = parts_below(gains, 1.0);
  parts.insert(parts.end(), near.begin(), near.end());
  const auto at_part = [&](std::size_t i) { return with_gain(choice, gains.value_at(parts[i])); };
  if (const auto failing = trials.first_failing(choice, parts.size(), at_part))
    return refute(trials, choice, choice.stiffness * gains.value_at(parts[failing->run]), failing->why);
  law.verified = parts.size();
  return false;
}

/// Finds the limits of K in the scene as chosen. Returns true if the own run has one before G K.
bool own_edge_is_near(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const ScenarioText& scene = trials.question().scenario;
  const std::vector<std::string> chosen = trials.overrides(choice.setting, choice.stiffness);
  LimitQuestion question = limit_question(scene, chosen, kStiffnessPath, {});
  question.rule = rule_of(load_scenario(scene, chosen).scenario);
  question.threads = trials.question().threads;
  law.edge = field_limit(question);
  trials.count_runs(law.edge.runs.size());
  const double G_K = trials.question().margin * choice.stiffness;
  if (!law.edge.end.value) return refute(trials, choice, G_K, "stable and unstable values alternate");
  if (!law.edge.end.beyond) return false;
  const auto& [K, verdict] = *law.edge.end.beyond;
  if (K < G_K) return refute(trials, choice, K, std::string(run_verdict_name(verdict)));
  trials.note_unstable(K);
  return false;
}

/// Returns true if a run twice as long is not settled.
bool fails_later(Trials& trials, const TuneTrial& choice) {
  const Scenario own = trials.load(choice.setting, choice.stiffness).scenario;
  const double duration = own.time.step * static_cast<double>(own.time.steps);
  // A script that leads on reaches positions beyond the end of the scene.
  if (script_moves_until(own) > duration && script_period(own) == 0.0) return false;
  const auto twice = [&](std::size_t) { return fmt::format("time.steps={}", 2 * own.time.steps); };
  const auto failing = trials.first_failing(choice, trials.family_size(), twice);
  if (!failing) return false;
  trials.set_cap(choice.stiffness / kMuchLess, "settled",
                 fmt::format("at {:.4g} N/m{}, in a run twice as long: {}", choice.stiffness,
                             setting_text(choice.setting), failing->why));
  return true;
}

/// Returns true if a limit of the user is not kept by as much as the metric's error. Then the limits are tightened.
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
  const LoadedScenario own = load_scenario(scene, chosen);
  const Cases once({scene}, chosen, std::vector<Axis>{});
  std::vector<Cases> finer = {finer_cases(level_sweep(own, kStepPath, 2, 2.0), once)};
  if (const auto distance = point_distance(own)) {
    finer.push_back(finer_cases(level_sweep(own, distance->path, 2, 2.0), once));
    finer.emplace_back(std::vector{scene}, chosen, std::vector<Axis>{{.path = "record.inside", .values = {"true"}}});
  }
  trials.count_runs(finer.size());
  const std::vector<Result> runs = run_all(finer, {trials.question().threads, ""});
  TuneMetrics error;
  for (const auto& [name, value] : trial.metrics) {
    double most = 0.0;
    for (const Result& run : runs) {
      const double moved = number_of(run.metrics, name).value_or(std::numeric_limits<double>::infinity());
      most = std::max(most, std::abs(moved - value));
    }
    if (std::isfinite(most)) error[name] = most;
  }
  return error;
}

bool is_verified(Trials& trials, TuneTrial& choice, TunedLaw& law) {
  return !fails_between(trials, choice, law) && !own_edge_is_near(trials, choice, law) &&
         !fails_later(trials, choice) && !is_beyond_limits(trials, choice, law);
}

}  // namespace hapbench
