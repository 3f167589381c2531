#include "scenarios/analysis/tuning/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/run/scripted_motion.hpp"

namespace hapbench {
namespace {

// If a longer run is not settled, all stiffnesses above K / kStiffnessReduction are refuted, where K is the choice's
// stiffness; if the diagnosis condemns the choice, the stiffnesses from there to K.
constexpr double kStiffnessReduction = 1.25;

/// Records that K is not settled. Refutes all stiffnesses from the smaller of K / G and the stiffness of the choice to
/// the larger of K and the stiffness of the choice. Returns true.
bool refute(Trials& trials, const TuneTrial& choice, double K, const std::string& why) {
  trials.note_unstable(K);
  const double lowest = std::min(K / trials.question().margin, choice.stiffness) * (1.0 - kTuneResolution);
  trials.refute(choice.setting, lowest, std::max(K, choice.stiffness), "margin",
                fmt::format("{} (K = {:.4g} N/m{})", why, K, setting_text(choice.setting)));
  return true;
}

/// Returns true if a run is not settled with the recommended stiffness multiplied by a gain. Tries gains between 1 and
/// the margin of the question, and gains just below the margin.
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

/// Finds the stability limits of K in the scene with the choice. Returns true, and refutes the choice, if there is a
/// limit below G K or no contiguous stable interval.
bool scene_limit_is_near(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  const ScenarioText& scene = trials.question().scenario;
  const std::vector<std::string> chosen = trials.trial_runs().overrides(choice.setting, choice.stiffness);
  LimitQuestion question = limit_question(scene, chosen, kStiffnessPath, {});
  question.rule = rule_of(load_scenario(scene, chosen).scenario);
  question.threads = trials.question().threads;
  law.limits = field_limit(question);
  trials.count_runs(law.limits.runs.size());
  const double G_K = trials.question().margin * choice.stiffness;
  // Reject a choice without a contiguous stable interval, or with a limit below G K.
  if (!law.limits.end.value) return refute(trials, choice, G_K, "stable and unstable values alternate");
  if (law.limits.linear && *law.limits.linear < G_K)
    return refute(trials, choice, *law.limits.linear, "the contact loop is unstable");
  if (!law.limits.end.beyond) return false;
  const auto& [K, verdict] = *law.limits.end.beyond;
  if (K < G_K) return refute(trials, choice, K, std::string(run_verdict_name(verdict)));
  trials.note_unstable(K);
  return false;
}

/// Returns true if at least one variant is not settled in a run twice as long as the scene's run.
bool fails_in_longer_run(Trials& trials, const TuneTrial& choice) {
  const Scenario scenario = trials.trial_runs().load(choice.setting, choice.stiffness).scenario;
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  // A run of twice the duration verifies the choice. Skip it if a script that is not periodic still moves the tool
  // after the end of the scene, because the tool would reach other positions than in the scene.
  if (script_moves_until(scenario) > duration && script_period(scenario) == 0.0) return false;
  const auto twice = [&](std::size_t) { return fmt::format("time.steps={}", 2 * scenario.time.steps); };
  const auto failing = trials.first_failing(choice, trials.variant_count(), twice);
  if (!failing) return false;
  trials.refute(choice.setting, choice.stiffness / kStiffnessReduction, std::numeric_limits<double>::infinity(),
                "settled",
                fmt::format("{} (K = {:.4g} N/m{}, in a run twice as long)", failing->why, choice.stiffness,
                            setting_text(choice.setting)));
  return true;
}

/// Returns true if the run of the scene vibrates at a stiffness from kLowVibrationFrom x K to K, for example because
/// the choice lies between two resonances. Then refutes the stiffnesses from the lowest such stiffness to the largest
/// one that has it so near below it. Uses the known trials of the setting; if none of them vibrates, makes further
/// runs.
bool vibrates_nearby(Trials& trials, const TuneTrial& choice) {
  if (trials.limits().allow_vibration) return false;
  const Range nearby{kLowVibrationFrom * choice.stiffness, choice.stiffness, true};
  std::map<double, TuneFailure> failures = trials.known_vibrations(choice.setting, nearby);  // by stiffness
  if (failures.empty()) {
    std::vector<double> stiffnesses;
    for (const double t : parameters_between(0.0, 1.0, kLowVibrationSamples)) stiffnesses.push_back(nearby.value_at(t));
    const auto found = trials.vibrations(choice.setting, stiffnesses);
    for (std::size_t i = 0; i < found.size(); ++i)
      if (found[i]) failures.emplace(stiffnesses[i], *found[i]);
  }
  if (failures.empty()) return false;
  const auto& [K, failure] = *failures.begin();
  trials.refute(choice.setting, K * (1.0 - kTuneResolution), K / kLowVibrationFrom, failure.binding,
                fmt::format("{} (K = {:.4g} N/m{})", failure.why, K, setting_text(choice.setting)));
  return true;
}

/// Returns true if the diagnosis of the scene's run reports a failure or a vibration that is not allowed. The run is
/// the same that the command `run` makes with the recommended scenario, so that `run` does not contradict `tune`.
bool is_condemned_by_run(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  law.findings = trials.findings(choice);
  const auto condemns = [&](const Diagnosed& found) {
    const RuleKind kind = rule_kind(found.rule);
    return kind == RuleKind::failure || (kind == RuleKind::low_vibration && !trials.limits().allow_vibration);
  };
  const auto found = std::ranges::find_if(law.findings, condemns);
  if (found == law.findings.end()) return false;
  trials.refute(choice.setting, choice.stiffness / kStiffnessReduction, choice.stiffness * (1.0 + kTuneResolution),
                found->rule,
                fmt::format("{} (K = {:.4g} N/m{})", found->says, choice.stiffness, setting_text(choice.setting)));
  return true;
}

}  // namespace

std::string with_gain(const TuneTrial& trial, double gain) {
  return fmt::format("{}={}", kStiffnessPath, gain * trial.stiffness);
}

bool is_verified(Trials& trials, const TuneTrial& choice, TunedLaw& law) {
  return !is_condemned_by_run(trials, choice, law) && !vibrates_nearby(trials, choice) &&
         !fails_between(trials, choice, law) && !scene_limit_is_near(trials, choice, law) &&
         !fails_in_longer_run(trials, choice);
}

}  // namespace hapbench
