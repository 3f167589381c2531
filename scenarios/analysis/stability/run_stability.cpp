#include "scenarios/analysis/stability/run_stability.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "results/observe/metrics.hpp"
#include "scenarios/analysis/stability/motion_classifier.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// Steps the simulation until it ends or comes to rest, and returns the class of its motion. Precondition: `classifier`
/// observes the simulation.
MotionClass classify(Simulation& simulation, const MotionClassifier& classifier) {
  const SimulationResult result = run_to_end(simulation, [&] {
    bool more = true;
    for (std::uint64_t i = 0; i < kStepsPerStopCheck && more; ++i) more = !classifier.at_rest() && simulation.step();
    return more;
  });
  return classifier.motion_class(result.ending);
}

/// Returns the classifier for the scenario. It depends on whether a script moves the tool.
MotionClassifier classifier_of(const Scenario& scenario) {
  const auto steps = static_cast<std::uint64_t>(scenario.time.steps);
  if (!has_scripted_motion(scenario)) return MotionClassifier(steps);
  return MotionClassifier::of_moved_tool(steps, scenario.time.step, script_moves_until(scenario) / scenario.time.step);
}

/// Returns the verdict by the vibration if `max_vibration` [m/s rms] has a value and the motion has not diverged.
/// Otherwise returns the class of the motion.
RunVerdict verdict_of(MotionClass motion, const SettledState& settled, std::optional<double> max_vibration) {
  if (!max_vibration || motion == MotionClass::diverged) return motion;
  return settled.vibration && *settled.vibration <= *max_vibration ? RunVerdict::stable : RunVerdict::vibrating;
}

/// Returns the verdict with the same name as the outcome; empty if no verdict has this name.
std::optional<RunVerdict> verdict_of(Outcome outcome) {
  const auto texts = run_verdict_texts();
  const auto found = std::ranges::find(texts, outcome_name(outcome), &RunVerdictText::name);
  if (found == texts.end()) return std::nullopt;
  return static_cast<RunVerdict>(found - texts.begin());
}

/// Returns true for the two verdicts on a tool that does not follow the hand that drags it.
bool is_left_behind(RunVerdict verdict) {
  return verdict == RunVerdict::stuck || verdict == RunVerdict::not_dragged;
}

/// Runs a trial of the scenario once with the scenario's length and returns the verdict.
RunStability judged_once(const Scenario& scenario, const NamedFiles& files,
                         const std::shared_ptr<const PointShell>& shell, const StabilityRule& rule, Trial trial) {
  // Run the trial with observers of its motion, its end and its outcome.
  MotionClassifier classifier = classifier_of(scenario);
  RunEndObserver run_end(scenario);
  SimulationParts parts = assemble(scenario, files, shell, trial);
  const std::shared_ptr<const ToolShape> tool = parts.tool;
  // Simulate the whole run, which the class of the motion needs. With RunLength::until_failure, the outcome observer
  // stops searching the depth of the tool after the tool has gone through the surface; the run goes on.
  const auto outcome_seen = outcome_observer(scenario, files, parts, nullptr, RunLength::until_failure);
  Simulation simulation(simulation_config(scenario), std::move(parts), {&classifier, &run_end, outcome_seen.get()});
  const MotionClass motion = classify(simulation, classifier);
  const SettledState settled = run_end.state(classifier.at_rest());
  const Outcome outcome = outcome_seen->outcome(simulation.result().ending);
  // Decide in this order: divergence, outcome, slow bounces. Then decide by the vibration if the rule limits it,
  // otherwise by the class of the motion.
  const auto verdict = [&] {
    if (motion == MotionClass::diverged) return RunVerdict::diverged;
    if (outcome == Outcome::went_through) return RunVerdict::went_through;
    if (!run_end.touched()) return RunVerdict::no_contact;
    if (outcome == Outcome::leaves_hole || (shell && run_end.has_left(*shell, tool->reach())))
      return RunVerdict::thrown_out;
    const auto known = verdict_of(outcome);
    if (known && (rule.judges_progress || !is_left_behind(*known))) return *known;
    const bool only_fast = rule.max_vibration || has_scripted_motion(scenario);
    if (only_fast && run_end.keeps_bouncing()) return RunVerdict::vibrating;
    return verdict_of(motion, settled, rule.max_vibration);
  };
  RunStability run{verdict(), settled, run_end.motion_hash()};
  run.undecided = is_stable(run.verdict) && classifier.is_undecided();
  run.fades = run.verdict == RunVerdict::vibrating && !rule.max_vibration && classifier.fades();
  return run;
}

/// Judges a trial. Extends a trial that is too short to judge.
RunStability judged(const CheckedScenario& checked, const std::shared_ptr<const PointShell>& shell,
                    const StabilityRule& rule, Trial trial) {
  constexpr int kMaxExtensions = 3;
  constexpr std::int64_t kExtensionFactor = 4, kMaxExtendedSteps = 1'000'000;
  RunStability run = judged_once(checked.scenario(), checked.files(), shell, rule, trial);
  Scenario longer = checked.scenario();
  for (int i = 0; run.undecided && i < kMaxExtensions && longer.time.steps * kExtensionFactor <= kMaxExtendedSteps;
       ++i) {
    longer.time.steps *= kExtensionFactor;
    const std::uint64_t motion_hash = run.motion_hash;
    run = judged_once(longer, checked.files(), shell, rule, trial);
    // Keep the hash of the unextended run, which can be compared with the hashes of other runs.
    run.motion_hash = motion_hash;
  }
  return run;
}

/// Raises the largest values of a settled state to those of another trial.
void add_extremes(SettledState& state, const SettledState& other) {
  state.vibration = std::max(state.vibration, other.vibration);  // an empty value is the smallest
  state.touch_speed = std::max(state.touch_speed, other.touch_speed);
  state.hand_force_max = std::max(state.hand_force_max, other.hand_force_max);
}

/// Judges the trials of the scenario up to the first trial that the rule does not count as stable.
RunStability judged_trials(const CheckedScenario& checked, const std::shared_ptr<const PointShell>& shell,
                           const StabilityRule& rule) {
  RunStability run = judged(checked, shell, rule, Trial{});
  const std::vector<Trial> trials = trials_of(checked.scenario());
  for (std::size_t i = 1; i < trials.size() && rule.holds(run.verdict); ++i) {
    RunStability next = judged(checked, shell, rule, trials[i]);
    Hash64 motions;
    motions.word(run.motion_hash);
    motions.word(next.motion_hash);
    next.motion_hash = motions.value();
    // A rule may count a vibrating trial as stable. The verdict on the run is then that it vibrates.
    if (!rule.holds(next.verdict) || (is_stable(run.verdict) && !is_stable(next.verdict))) {
      run = std::move(next);
    } else {
      if (is_stable(next.verdict)) run.verdict = std::max(run.verdict, next.verdict);
      add_extremes(run.settled, next.settled);
      run.undecided |= next.undecided;
      run.motion_hash = next.motion_hash;
    }
  }
  return run;
}

}  // namespace

RunStability stability_of(const CheckedScenario& checked, std::shared_ptr<const PointShell> shell,
                          const StabilityRule& rule) {
  RunStability run = judged_trials(checked, shell, rule);
  // Check the bounds on metrics in a complete run.
  if (!is_stable(run.verdict) || rule.bounds.empty()) return run;
  const Result full = run_with_shell(checked, shell);
  if (full.end.outcome == Outcome::went_through) {
    run.verdict = RunVerdict::went_through;
    return run;
  }
  run.violated = violated_bounds(rule.bounds, full);
  if (!run.violated.empty()) run.verdict = RunVerdict::beyond_bound;
  return run;
}

bool unstable_without_contact(const CheckedScenario& checked, std::optional<double> max_vibration) {
  Scenario scenario = checked.scenario();
  if (spring_of(scenario.hand) == nullptr || std::holds_alternative<SpringsEnvironment>(scenario.environment))
    return false;
  // Remove dry friction: it only dissipates energy, and stick-slip vibration is not an instability of the loop.
  if (auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) device->coulomb = 0.0;
  MotionClassifier classifier = classifier_of(scenario);
  RunEndObserver run_end(scenario, true);
  constexpr double kCells = 1.0;  // cell size of the grid that local_average needs [m]
  const auto nothing = std::make_shared<const PointShell>(std::vector<SurfacePoint>{}, kCells);
  Simulation simulation(simulation_config(scenario), assemble(scenario, checked.files(), nothing, {}),
                        {&classifier, &run_end});
  const MotionClass motion = classify(simulation, classifier);
  return !is_stable(verdict_of(motion, run_end.state(classifier.at_rest()), max_vibration));
}

}  // namespace hapbench
