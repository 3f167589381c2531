#include <fmt/format.h>

#include <algorithm>

#include "scenarios/run/run_scenario.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims about all three tasks of thesis 3.2: rendering is stable during the whole task, and depths are small
/// (abstract, 4.2, C.3).
namespace hapbench {
namespace {

// ---- S2: one case for each task and density.
// completes: 1 if the run has the outcome `completes`, otherwise 0.
// buzz, pop: values of the diagnosis's rules with these names; 0 if a rule has no value. buzz is the rms of the force's
//   part above 30 Hz, and pop the largest change of the force in one time step, both in settled contact and divided by
//   the mean force.
// disturbed: number of the diagnosis's rules for low vibration whose threshold is exceeded.

MeasuredValues stability_values(const LoadedScenario& loaded) {
  const Result run = run_scenario(checked(loaded), std::nullopt, false, nullptr, Diagnose::low_vibration);
  MeasuredValues values = {
      {"completes", {run.end.outcome == Outcome::completes ? 1.0 : 0.0}}, {"buzz", {0.0}}, {"pop", {0.0}}};
  double disturbed = 0.0;
  for (const Diagnosed& number : run.low_vibration) {
    if (number.rule == "buzz" || number.rule == "pop") values[number.rule] = {number.value};
    if (number.value > number.threshold) disturbed += 1.0;
  }
  values["disturbed"] = {disturbed};
  return values;
}

Measured measure_stability(const Evidence& e) {
  Measured measured;
  for (const std::string task : kTasks)
    for (const std::string density : kDensities)
      measured.push_back({task.substr(0, 5) + " " + density,
                          stability_values(e.load(task + "_" + density, {"record.ratio_iterations=[]"}))});
  return measured;
}

Finding judge_stability(const Measured& measured, const PublishedNumbers&) {
  std::size_t completed = 0, undisturbed = 0;
  double buzz = 0.0, pop = 0.0;
  for (const MeasuredCase& m : measured) {
    completed += m["completes"] == 1.0 ? 1U : 0U;
    undisturbed += m["completes"] == 1.0 && m["disturbed"] == 0.0 ? 1U : 0U;
    buzz = std::max(buzz, m["buzz"]);
    pop = std::max(pop, m["pop"]);
  }
  return {
      decide(undisturbed == measured.size(), completed == measured.size()),
      fmt::format("{} of {} runs complete; in {} of them, the diagnosis finds a fault that the rule names", completed,
                  measured.size(), completed - undisturbed),
      "",
      fmt::format(
          "{} of {} runs complete; the part of the force above 30 Hz has an rms of at most {:.2f} times the mean force",
          completed, measured.size(), buzz)};
}

// ---- G3: largest depth of a contact in each task and density [m].

Measured measure_depths(const Evidence& e) {
  Measured measured;
  for (const std::string task : kTasks)
    for (const std::string density : kDensities)
      measured.push_back(
          {task.substr(0, 5) + " " + density, {{"depth", {e.number(task + "_" + density, "metrics.depth_max_m")}}}});
  return measured;
}

Finding judge_depths(const Measured& measured, const PublishedNumbers& published) {
  double deepest = 0.0;
  for (const MeasuredCase& m : measured) deepest = std::max(deepest, m["depth"]);
  const bool small = deepest < published["G1.negligible"].at_most;
  return {decide(small, false),
          small ? "the limit of the input force keeps the depths small" : "some contact is deeper", "",
          fmt::format("largest depth of a contact in tasks 1 to 3: {:.3f} mm", 1e3 * deepest)};
}

}  // namespace

std::vector<ClaimRule> whole_tasks() {
  return {{"S2", measure_stability, judge_stability}, {"G3", measure_depths, judge_depths}};
}

}  // namespace hapbench
