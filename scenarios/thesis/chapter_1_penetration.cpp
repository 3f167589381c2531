#include <fmt/format.h>

#include <algorithm>

#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims of 1.1, 1.2 and B.3.1: how far a drill pressed into the hole sinks in under other ways to merge forces, and
/// what their plain sum does. The hand's direction is that of task 2.
namespace hapbench {
namespace {

constexpr double kPressedTilts[] = {0.35, 0.68, 1.0};  ///< [rad]
/// Rows between evaluations of the depth: 4 ms.
constexpr std::uint64_t kRowsBetweenLooks = 8;
/// Rows before this time are ignored [s]: the start is not the resting place at every tilt.
constexpr double kLanded = 0.5;

/// The largest depth of the drill in the block after it has landed, at each tilt [m]. The largest one, because a drill
/// that pops through has left the block at the end.
MeasuredCase pressed(const Evidence& e, const std::string& name, const std::string& scene,
                     std::vector<std::string> overrides) {
  MeasuredCase m{name, {}};
  overrides.emplace_back();
  for (const double tilt : kPressedTilts) {
    overrides.back() = fmt::format("motion.orientation.tilt_rad={}", tilt);
    const LoadedScenario loaded = e.load(scene, overrides);
    IdealTrajectoryObserver ideal(std::get<BlockEnvironment>(loaded.scenario.environment).block,
                                  make_cylinder(loaded.scenario.tool));
    double& deepest = m.values[fmt::format("at_{}", tilt)].emplace_back(0.0);
    for_each_row(loaded, [&](const StepRecord& row) {
      if (row.step % kRowsBetweenLooks != 0 || row.time < kLanded) return;
      ideal.on_step(row);
      if (ideal.error()) deepest = std::max(deepest, ideal.error()->interpenetration);
    });
  }
  return m;
}

/// Stiffness shaping with the reduction, as the thesis has it.
MeasuredCase pressed_shaped(const Evidence& e) {
  return pressed(e, kProposedLaw, "press_towards_rim", {});
}

/// True if at every tilt `a` is at least `factor` times as deep as `b`.
bool deeper(const MeasuredCase& a, const MeasuredCase& b, double factor) {
  return std::ranges::all_of(a.values, [&](const auto& depth) { return a[depth.first] >= factor * b[depth.first]; });
}

/// Whether the drill sinks in easily with the second case's law, beside shaping, the first one.
Finding judge_sinking(const Measured& m, const PublishedNumbers& p) {
  const bool easily = deeper(m.at(1), m.at(0), threshold(p, "easily")), more = deeper(m.at(1), m.at(0), 1.0);
  return {decide(easily, more), fmt::format("with {} the drill sinks in {}", m.at(1).name,
                                            easily ? "easily"
                                            : more ? "further than with stiffness shaping, not easily"
                                                   : "less than with stiffness shaping at some tilt")};
}

Measured measure_averaging(const Evidence& e) {
  return {pressed_shaped(e),
          pressed(e, "mean", "press_towards_rim", {"rendering.algorithm=mean", "rendering.reduction=null"}),
          pressed(e, "mean after the reduction", "press_towards_rim", {"rendering.algorithm=mean"})};
}

// ---- B1b, B5: a drill that is turned in the hole, as B.3.1 has it, with the proposed algorithm and the original one
// of appendix B: its depth while it is near the hole [m], and under which hands it goes through the block's surface.

constexpr const char* kOriginalLaw = "original_averaging";

Result turned(const Evidence& e, const std::string& law, double force) {
  std::vector<std::string> overrides = {fmt::format("hand.force_N={}", force)};
  if (law == kOriginalLaw)
    overrides.insert(overrides.end(), {"rendering.algorithm=" + law, "rendering.depth_model=shortest_distance",
                                       "rendering.local_average=false", "rendering.reduction=null"});
  return e.run("task2_held", overrides);
}

Measured measure_original(const Evidence& e) {
  Measured measured;
  for (const std::string law : {kProposedLaw, kOriginalLaw}) {
    const Result run = turned(e, law, 1.0);
    const auto depth = number_of(run.metrics, "ideal_trajectory.gentle.interpenetration_max_m");
    measured.push_back({law, {{"depth", {depth.value_or(0.0)}}}});
  }
  return measured;
}

Finding judge_original(const Measured& m, const PublishedNumbers& p) {
  const double times = m.at(1)["depth"] / m.at(0)["depth"];
  return {decide(times >= threshold(p, "easily"), times > 1.0),
          fmt::format("{:.2g} times as deep as with stiffness shaping", times)};
}

constexpr double kHands[] = {0.5, 1.0, 2.0, 3.5};  ///< [N]

MeasuredValues measure_pop_through(const Evidence& e) {
  MeasuredValues values = {{"hands", {static_cast<double>(std::size(kHands))}}};
  for (const std::string law : {kProposedLaw, kOriginalLaw})
    values[law] = {static_cast<double>(std::ranges::count_if(
        kHands, [&](double force) { return turned(e, law, force).end.outcome == Outcome::went_through; }))};
  return values;
}

Finding judge_pop_through(const MeasuredCase& m, const PublishedNumbers&) {
  const double original = m[kOriginalLaw], proposed = m[kProposedLaw];
  return {
      decide(original > 0.0 && proposed == 0.0, original > proposed),
      original > 0.0 ? "beyond the median line flipped gradients pull the drill on" : "the drill stays in the hole"};
}

// ---- S1: the plain sum of all points, in the planar peg and in the turn of task 2, beside stiffness shaping.

Finding judge_summation(const Measured& m, const PublishedNumbers& p) {
  const auto unstable = [&](std::size_t i) {
    return m.at(i)["diverges"] == 1.0 || vibrates_much_more(m.at(i), m.at(i + 1), p);
  };
  const bool peg = unstable(0), task = unstable(2);
  return {decide(peg && task, peg || task),
          fmt::format("n points are up to n K: in the planar peg the sum is {}, in task 2 {}",
                      peg ? "unstable" : "stable", task ? "unstable" : "stable")};
}

}  // namespace

std::vector<ClaimRule> chapter_1_penetration() {
  return {
      {"V1", measure_averaging, judge_sinking},
      {"V2",
       [](const Evidence& e) -> Measured {
         return {pressed_shaped(e), pressed(e, "virtual coupling", "press_coupled", {})};
       },
       judge_sinking},
      {"S1",
       [](const Evidence& e) { return vibrations_beside_shaping(e, "summation", "task2_held", {"metrics.from_s=0"}); },
       judge_summation},
      {"B1b", measure_original, judge_original},
      single_case<measure_pop_through, judge_pop_through>("B5"),
  };
}

}  // namespace hapbench
