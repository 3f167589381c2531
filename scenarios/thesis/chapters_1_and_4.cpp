#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/penalty_rendering.hpp"
#include "algorithms/registry.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims of chapters 1 and 4 of the thesis:
///   - How deep a pressed drill sinks into the block, with other methods of merging forces than stiffness shaping and
///     with the plain sum of forces (1.1, 1.2, B.3.1).
///   - Limitations of both depth models (4.2).
///   - Other limitations that the thesis discusses.
namespace hapbench {
namespace {

// ---- V1, V2: a hand presses a drill into the hole. The tilt of the drill is constant, and the direction of the hand's
// force is as in task 2.

constexpr double kPressedTilts[] = {0.35, 0.68, 1.0};  ///< [rad]
/// Number of steps between two evaluations of the depth; these steps take 4 ms of simulated time.
constexpr std::uint64_t kStepsBetweenEvaluations = 8;
/// The depth is measured from this time on [s]. At an earlier time, the drill has not yet reached its resting position
/// at some tilts.
constexpr double kLanded = 0.5;

/// Returns the name of the depth at a tilt.
std::string at_tilt(double tilt) {
  return fmt::format("at_{}", tilt);
}

/// Returns the largest depth of the drill in the block after kLanded, at each tilt [m]. The final depth would not be
/// enough: a drill that passes through the block has left the block at the end. For a run that diverges, see
/// MeasuredCase::set_diverged().
MeasuredCase pressed(const Evidence& e, const std::string& name, const std::string& scene,
                     std::vector<std::string> overrides = {}) {
  MeasuredCase m{name, {}};
  overrides.emplace_back();
  for (const double tilt : kPressedTilts) {
    overrides.back() = fmt::format("motion.orientation.tilt_rad={}", tilt);
    const LoadedScenario loaded = e.load(scene, overrides);
    IdealTrajectoryObserver ideal(std::get<BlockEnvironment>(loaded.scenario.environment).block,
                                  make_cylinder(loaded.scenario.tool));
    double deepest = 0.0;
    const auto rows = static_cast<std::uint64_t>(loaded.scenario.time.steps);
    bool complete = false;
    for_each_row(checked(loaded), [&](const StepRecord& row) {
      complete = row.step + 1 == rows;
      if (row.step % kStepsBetweenEvaluations != 0 || row.time < kLanded) return;
      ideal.on_step(row);
      if (ideal.error()) deepest = std::max(deepest, ideal.error()->interpenetration);
    });
    // A run that diverges does not reach its last row.
    if (complete)
      m.values[at_tilt(tilt)] = {deepest};
    else
      m.set_diverged(at_tilt(tilt), deepest);
  }
  return m;
}

/// Returns the largest depth over the tilts [m]; NaN if the run at some tilt diverges.
double deepest(const MeasuredCase& m) {
  double largest = 0.0;
  for (const double tilt : kPressedTilts) {
    const double depth = m[at_tilt(tilt)];
    if (std::isnan(depth)) return depth;
    largest = std::max(largest, depth);
  }
  return largest;
}

/// Judges whether the drill sinks in easily with the law of the second case. Compares its largest depth over the tilts
/// with the largest depth of stiffness shaping (first case).
Finding judge_sinking(const Measured& m, const PublishedNumbers& p) {
  const double law = deepest(m.at(1)), shaped = deepest(m.at(0));
  const bool easily = law >= threshold(p, "easily") * shaped, more = law > shaped;
  return {decide(easily, more),
          fmt::format("with `{}` the drill sinks in {}", m.at(1).name,
                      easily ? "easily"
                      : more ? "deeper than with stiffness shaping, but not easily"
                             : "no deeper than with stiffness shaping"),
          "", fmt::format("largest depth {:.2f} mm, with stiffness shaping {:.2f} mm", 1e3 * law, 1e3 * shaped)};
}

/// The earlier rule of V1 and V2: the drill sinks in easily, or deeper, at every tilt. It ignored that a run with
/// stiffness shaping may diverge.
Verdict judge_sinking_at_every_tilt(const Measured& m, const PublishedNumbers& p) {
  bool easily = true, more = true;
  for (const double tilt : kPressedTilts) {
    const double law = m.at(1).until_divergence(at_tilt(tilt)), shaped = m.at(0).until_divergence(at_tilt(tilt));
    easily = easily && law >= threshold(p, "easily") * shaped;
    more = more && law > shaped;
  }
  return decide(easily, more);
}

Measured measure_averaging(const Evidence& e) {
  return {pressed(e, kProposedLaw, "press_towards_rim"),  // with the reduction, as in the thesis
          pressed(e, "mean", "press_towards_rim", {"rendering.algorithm=mean", "rendering.reduction=null"}),
          pressed(e, "mean after the reduction", "press_towards_rim", {"rendering.algorithm=mean"})};
}

// ---- B1b, B5: a drill turned in the hole as in thesis B.3.1, with the proposed algorithm and with the original
// algorithm of appendix B.
// B1b: largest depth [m] of the drill while it is near the hole, with a hand of 1 N. For a run that diverges, see
//   MeasuredCase::set_diverged().
// B5: number of the hand forces kHands with which the drill passes through the surface. For the proposed algorithm, a
//   run that diverges also counts; "diverging" is the number of these runs.

constexpr const char* kOriginalLaw = "original_averaging";

/// Runs task 2 with a law and a hand of constant force [N]. kOriginalLaw is run as in appendix B: with the shortest
/// distance as depth model, without local average and reduction. Precondition: the law is kOriginalLaw or kProposedLaw.
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
    MeasuredCase& m = measured.emplace_back(MeasuredCase{law, {{"depth", {depth.value_or(0.0)}}}});
    if (run.end.outcome == Outcome::diverges) m.set_diverged("depth", depth.value_or(0.0));
  }
  return measured;
}

Finding judge_original(const Measured& m, const PublishedNumbers& p) {
  const double times = m.at(1)["depth"] / m.at(0)["depth"];
  return {decide(times >= threshold(p, "easily"), times > 1.0),
          fmt::format("{:.2g} times as deep as with stiffness shaping", times)};
}

/// The earlier rule of B1b ignored that the run with stiffness shaping may diverge.
Verdict judge_original_before(const Measured& m, const PublishedNumbers& p) {
  const double times = m.at(1).until_divergence("depth") / m.at(0).until_divergence("depth");
  return decide(times >= threshold(p, "easily"), times > 1.0);
}

constexpr double kHands[] = {0.5, 1.0, 2.0, 3.5};  ///< [N]

MeasuredValues measure_pop_through(const Evidence& e) {
  double original = 0.0, proposed = 0.0, diverging = 0.0;
  for (const double force : kHands) {
    original += turned(e, kOriginalLaw, force).end.outcome == Outcome::went_through ? 1.0 : 0.0;
    const Outcome outcome = turned(e, kProposedLaw, force).end.outcome;
    diverging += outcome == Outcome::diverges ? 1.0 : 0.0;
    proposed += outcome == Outcome::diverges || outcome == Outcome::went_through ? 1.0 : 0.0;
  }
  return {{"hands", {static_cast<double>(std::size(kHands))}},
          {kOriginalLaw, {original}},
          {kProposedLaw, {proposed}},
          {"diverging", {diverging}}};
}

Finding judge_pop_through(const MeasuredCase& m, const PublishedNumbers&) {
  const double original = m[kOriginalLaw], proposed = m[kProposedLaw];
  return {decide(original > 0.0 && proposed == 0.0, original > proposed),
          original > 0.0 ? "where the drill is deeper in the block than half its width, the gradients are reversed and "
                           "pull it farther in"
                         : "the drill stays in the hole"};
}

/// The earlier rule of B5 ignored that a run with the proposed algorithm may diverge.
Verdict judge_pop_through_before(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.front();
  const double original = m[kOriginalLaw], proposed = m[kProposedLaw] - m["diverging"];
  return decide(original > 0.0 && proposed == 0.0, original > proposed);
}

// ---- S1, B4: vibration of two laws, compared with stiffness shaping in the planar peg scene and in task 2. The law of
// S1 is the plain sum of the forces of all points. The law of B4 renders the largest depth along the averaged
// direction. Each case has the values of vibration(), and the value "diverges" (1 or 0).

/// Returns four cases: planar peg with the law, planar peg with shaping, task with the law, task with shaping.
/// `task_name`: name of the scenario `task` in the cases.
Measured vibrations_beside_shaping(const Evidence& e, const std::string& law, const std::string& task,
                                   const std::string& task_name, const std::vector<std::string>& overrides_of_task) {
  Measured measured;
  for (const std::string& scene : {std::string("peg_in_hole_2d_frictionless_shaped_stiffness"), task}) {
    for (const std::string& algorithm : {law, std::string(kProposedLaw)}) {
      std::vector<std::string> overrides = {"rendering.algorithm=" + algorithm, "rendering.reduction=null",
                                            "record.ratio_iterations=[]"};
      if (scene == task) overrides.insert(overrides.end(), overrides_of_task.begin(), overrides_of_task.end());
      const Result run = e.run(scene, overrides);
      const auto measure = algorithm == kProposedLaw ? reference_vibration : vibration;
      measured.push_back(measure(algorithm + ", " + (scene == task ? task_name : "planar peg"), run));
      measured.back().values["diverges"] = {run.end.outcome == Outcome::diverges ? 1.0 : 0.0};
    }
  }
  return measured;
}

Finding judge_summation(const Measured& m, const PublishedNumbers& p) {
  const auto unstable = [&](std::size_t i) {
    const bool stable_reference = m.at(i + 1)["diverges"] == 0.0;
    return stable_reference && (m.at(i)["diverges"] == 1.0 || vibrates_much_more(m.at(i), m.at(i + 1), p));
  };
  const bool peg = unstable(0), task = unstable(2);
  return {
      decide(peg && task, peg || task),
      fmt::format(
          "n contacts have a stiffness of up to n K: the sum is {} with the planar peg and {} with the drill held in "
          "the hole",
          peg ? "unstable" : "stable", task ? "unstable" : "stable")};
}

Finding judge_highest_depth(const Measured& m, const PublishedNumbers& p) {
  const bool peg = vibrates_much_more(m.at(0), m.at(1), p), task = vibrates_much_more(m.at(2), m.at(3), p);
  return {
      decide(peg || task, vibrates_more(m.at(0), m.at(1)) && vibrates_more(m.at(2), m.at(3))),
      fmt::format(
          "the averaged direction turns quickly where gradients cancel: the tool {} in the planar peg-in-hole and {} "
          "in task 2",
          peg ? "vibrates" : "does not vibrate much more", task ? "vibrates" : "does not vibrate much more")};
}

// The earlier rules of S1 and B4 ignored that the run with stiffness shaping may diverge.

Verdict judge_summation_before(const Measured& m, const PublishedNumbers& p) {
  const auto unstable = [&](std::size_t i) {
    return m.at(i)["diverges"] == 1.0 || vibrates_much_more(m.at(i), until_divergence(m.at(i + 1)), p);
  };
  return decide(unstable(0) && unstable(2), unstable(0) || unstable(2));
}

Verdict judge_highest_depth_before(const Measured& m, const PublishedNumbers& p) {
  const MeasuredCase peg = until_divergence(m.at(1)), task = until_divergence(m.at(3));
  return decide(vibrates_much_more(m.at(0), peg, p) || vibrates_much_more(m.at(2), task, p),
                vibrates_more(m.at(0), peg) && vibrates_more(m.at(2), task));
}

// ---- G1: gradients on both sides of the tool's median line: the inner product of the gradients for two wall points,
// by both depth models. If it is negative, the gradient flips.

constexpr double kSameDirection = 0.999;  ///< smallest inner product of equal directions

MeasuredValues measure_median_line(const Evidence&) {
  const auto product = [](const char* model) {
    return wall_point(-0.0001, model).gradient(0).dot(wall_point(0.0001, model).gradient(0));
  };
  return {{"shortest_product", {product("shortest_distance")}}, {"normal_product", {product("surface_normal")}}};
}

Finding judge_median_line(const MeasuredCase& m, const PublishedNumbers&) {
  const bool flips = m["shortest_product"] < 0.0;
  const bool steady = m["normal_product"] > kSameDirection;
  return {decide(flips && steady, flips),
          fmt::format("the shortest distance {}, the surface normal {}", flips ? "flips" : "does not flip",
                      steady ? "does not" : "turns, too")};
}

// ---- G1b: the effect of the underestimated depth in task 2. The thesis calls the error negligible, because depths are
// small on its system. Two depth models are compared: the model of the thesis (surface_normal), and the depth along the
// normal (normal_projection). Depths and forces are compared for the same contacts, in steps whose largest depth is at
// most the depth that the thesis names. The path of the tool is compared between two runs, one with each depth model.

/// Steps between samples, about 30 samples in a second.
constexpr std::uint64_t kStepsBetweenSamples = 64;

MeasuredValues measure_underestimation(const Evidence& e) {
  const double shallow = e.published["G1.negligible"].at_most;
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance");
  const Cylinder tool = make_cylinder(loaded.scenario.tool);
  const auto law = make_law(kProposedLaw, loaded.scenario.rendering);
  // Compare depths and forces of the same contacts by both depth models, and record the path of the tool.
  std::vector<double> error, share;
  std::vector<Vec3> path;
  double difference = 0.0, force = 0.0;
  for_each_row(checked(loaded), [&](const StepRecord& row) {
    if (row.step % kStepsBetweenSamples != 0) return;
    path.push_back(row.tool.pose.position);
    const auto with_depths = [&](const char* model) {
      ContactBuffer contacts(row.found->size());
      contacts.assign(*row.found);
      find_depth_model(model)->make()->evaluate(tool, row.tool.pose, contacts);
      contacts.pad();
      return contacts;
    };
    ContactBuffer exact = with_depths("normal_projection"), shortest = with_depths("surface_normal");
    if (exact.empty() || exact.largest_depth() > shallow) return;
    law->prepare(exact.size());
    const Vec3 right = law->evaluate(exact).spring;
    difference += (law->evaluate(shortest).spring - right).squaredNorm();
    force += right.squaredNorm();
    for (std::size_t i = 0; i < exact.size(); ++i) {
      error.push_back(exact.depth[i] - shortest.depth[i]);
      if (exact.depth[i] > 0.0) share.push_back(error.back() / exact.depth[i]);
    }
  });
  if (error.empty()) throw NothingToMeasure("no step of the run has a contact that is shallow enough");
  // Compare the path with the path of a run with the depth along the normal.
  std::sort(error.begin(), error.end());
  double distance = 0.0;
  std::size_t sample = 0;
  for_each_row(checked(e.load("task2_rotate_signed_distance", {"rendering.depth_model=normal_projection"})),
               [&](const StepRecord& row) {
                 if (row.step % kStepsBetweenSamples != 0 || sample >= path.size()) return;
                 distance += (row.tool.pose.position - path[sample++]).squaredNorm();
               });
  return {{"contacts", {static_cast<double>(error.size())}},
          {"depth_mean", {mean_of(error)}},
          {"depth_95", {error.at(error.size() * 95 / 100)}},
          {"depth_max", {error.back()}},
          {"share", {mean_of(share)}},
          {"force", {std::sqrt(difference / force)}},
          {"way", {std::sqrt(distance / static_cast<double>(sample))}}};
}

Finding judge_underestimation(const MeasuredCase& m, const PublishedNumbers& published) {
  const double small = threshold(published, "negligible"), shallow = published["G1.negligible"].at_most;
  const bool force = m["force"] <= small, path = m["way"] <= small * shallow, depth = m["depth_95"] <= small * shallow;
  return {
      decide(force && path, force || path || depth),
      fmt::format(
          "the error of the depth is {} of the limit of {} mm for 95 % of the contacts; the error of the force is {}, "
          "the error of the path is {}",
          depth ? "a negligible part" : "no negligible part", plain(1e3 * shallow),
          force ? "negligible" : "not negligible", path ? "negligible" : "not negligible")};
}

// ---- G2: computing time of the depth of one contact [s], for contacts of task 2, with two depth models: along the
// normal (normal_projection), and as in the thesis (surface_normal).

MeasuredValues measure_depth_cost(const Evidence& e) {
  const std::vector<ContactBuffer> sets =
      contact_sets(e.load("task2_rotate_signed_distance").scenario, kStepsBetweenSamples);
  double contacts = 0.0;
  for (const ContactBuffer& set : sets) contacts += static_cast<double>(set.size());
  // The difference of the times of 17 evaluations and of one does not contain the time of copying the contact sets,
  // which is longer than one evaluation.
  constexpr int kFurther = 16;
  ContactBuffer copy(largest_of(sets).size());
  const auto seconds_further = [&](const char* model) {
    const auto depth = find_depth_model(model)->make();
    const auto seconds_of_evaluations = [&](int count) {
      return seconds_of_pass(sets, copy, [&](ContactBuffer& set) {
        for (int i = 0; i < count; ++i) depth->evaluate(kDrill, kUpright, set);
      });
    };
    return seconds_of_evaluations(1 + kFurther) - seconds_of_evaluations(1);
  };
  // Every repetition measures both models, so that a processor that becomes slower or faster changes both times.
  MeasuredValues seconds;
  for (int i = 0; i < kRepetitions; ++i)
    for (const char* model : {"normal_projection", "surface_normal"})
      seconds[model].push_back(seconds_further(model) / kFurther / contacts);
  for (auto& [model, values] : seconds) {
    values = {median(std::move(values))};
    if (!(values.front() > 0.0))
      throw NothingToMeasure("the computing time of a depth is below the noise of the clock");
  }
  return seconds;
}

Finding judge_depth_cost(const MeasuredCase& m, const PublishedNumbers& p) {
  const double times = m["normal_projection"] / m["surface_normal"];
  return {decide(times >= threshold(p, "huge"), times >= threshold(p, "margin")),
          fmt::format(
              "the depth along the normal takes {:.2g} times as long as the shortest distance; this is for a cylinder, "
              "and tools that are meshes were not measured",
              times)};
}

// ---- C8: largest difference between two forces on the flat surface of task 1, divided by the largest force. The first
// force is computed by the law "highest_depth" from all points, as in reference [3] of the thesis. The second force is
// computed by stiffness shaping from the points after the reduction.

constexpr double kIdentical = 1e-9;  // stated in the rule's text

MeasuredValues measure_one_direction(const Evidence& e) {
  const Scenario scenario = e.load("task1_flat_signed_distance").scenario;
  const auto reduction = make_gradient_reduction({});
  reduction->prepare({});
  double difference = 0.0, largest = 0.0;
  for (ContactBuffer& set : contact_sets(scenario, kStepsBetweenSamples)) {
    const auto force_of = [&](const char* name) {
      const auto law = make_law(name, scenario.rendering);
      law->prepare(set.size());
      return law->evaluate(set).spring;
    };
    const Vec3 highest = force_of("highest_depth");
    reduction->process(set);
    difference = std::max(difference, (force_of(kProposedLaw) - highest).norm());
    largest = std::max(largest, highest.norm());
  }
  return {{"apart", {difference / largest}}};
}

Finding judge_one_direction(const MeasuredCase& m, const PublishedNumbers&) {
  const bool same = m["apart"] <= kIdentical;
  return {decide(same, false),
          same ? "the reduction keeps the deepest of the contacts with equal gradients" : "the forces differ"};
}

// ---- C1: over-reduction: the reduction leaves one point of many, which changes the force.

constexpr double kPointsLeft = 1.0, kFewestPoints = 10.0;  // stated in the rule's text

MeasuredValues measure_over_reduction(const Evidence& e) {
  const char *reduced = "over_reduction_reduced", *unreduced = "over_reduction_unreduced";
  const auto a = e.table(reduced, "trajectory.csv"), b = e.table(unreduced, "trajectory.csv");
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < b.at("fx_N").size(); ++i) {
    const Vec3 with{a.at("fx_N")[i], a.at("fy_N")[i], a.at("fz_N")[i]};
    const Vec3 without{b.at("fx_N")[i], b.at("fy_N")[i], b.at("fz_N")[i]};
    difference = std::max(difference, (with - without).norm());
    largest = std::max(largest, without.norm());
  }
  return {{"reduced_max", {e.number(reduced, "metrics.rendered_max")}},
          {"unreduced_max", {e.number(unreduced, "metrics.rendered_max")}},
          {"force_difference", {difference / largest}}};
}

Finding judge_over_reduction(const MeasuredCase& m, const PublishedNumbers& p) {
  const bool collapsed = m["reduced_max"] == kPointsLeft && m["unreduced_max"] >= kFewestPoints;
  const bool matters = m["force_difference"] >= threshold(p, "over_reduced");
  return {decide(collapsed && matters, collapsed),
          collapsed ? "each point replaces its similar, shallower predecessor until one is left"
                    : "more than one point is left"};
}

// ---- C2, C7: a hand holds a tool in place and rotates it into a wall, at the scene's speed (C2) and at a low speed
// (C7). The damping of the thesis, which ignores the angular velocity, is compared with a damping that includes it.

Measured measure_turn_into_wall(const Evidence& e, const std::vector<std::string>& overrides) {
  return {vibration("damping from the velocity of the tip", e.run("turned_into_wall", overrides)),
          vibration("damping also from the rotation", e.run("turned_into_wall_angular_damping", overrides))};
}

Finding judge_turn_into_wall(const Measured& measured, const PublishedNumbers& p) {
  const MeasuredCase &blind = measured.at(0), &seeing = measured.at(1);
  const double more = blind["velocity_variation"] / seeing["velocity_variation"];
  const bool reverses = blind["force_reversals"] > seeing["force_reversals"];
  return {decide(more >= threshold(p, "turn") && reverses, more > 1.0),
          fmt::format(
              "the force reverses {} times; if the damping also uses the rotation of the tool, it {}reverses {} times",
              blind["force_reversals"], reverses ? "" : "also ", seeing["force_reversals"]),
          "",
          fmt::format("the total variation of velocity ({:.2f} m/s) is {:.2g} times the value with damping that also "
                      "uses the rotation of the tool ({:.2f} m/s)",
                      blind["velocity_variation"], more, seeing["velocity_variation"])};
}

Finding judge_slow_turn(const Measured& measured, const PublishedNumbers& p) {
  Finding finding = judge_turn_into_wall(measured, p);
  const bool reverses_no_more = measured.at(0)["force_reversals"] <= measured.at(1)["force_reversals"];
  const bool same = measured.at(0)["velocity_variation"] < threshold(p, "turn") * measured.at(1)["velocity_variation"];
  finding.verdict = decide(same && reverses_no_more, same || reverses_no_more);
  return finding;
}

// ---- C3: a drill between two parallel faces: its depth [m] and the rendered force [N].

MeasuredValues measure_parallel_faces(const Evidence& e) {
  const Scenario scenario = e.load("parallel_faces").scenario;
  const double depth = e.number("parallel_faces", "metrics.depth_max_m");
  return {{"depth", {depth}},
          {"radius", {make_cylinder(scenario.tool).radius()}},
          {"force", {e.number("parallel_faces", "metrics.force_max_N")}},
          {"one_wall_force", {scenario.rendering.stiffness * depth}}};
}

Finding judge_parallel_faces(const MeasuredCase& m, const PublishedNumbers& p) {
  const bool sinks = m["depth"] >= threshold(p, "sinks_in") * m["radius"];
  const bool weightless = m["force"] < threshold(p, "no_force") * m["one_wall_force"];
  return {decide(sinks && weightless, weightless),
          weightless ? "the forces of the two walls cancel" : "the walls push back"};
}

}  // namespace

std::vector<ClaimRule> chapters_1_and_4() {
  return {{"V1", measure_averaging, judge_sinking, {judge_sinking_at_every_tilt}},
          {"V2",
           [](const Evidence& e) {
             return Measured{pressed(e, kProposedLaw, "press_towards_rim"),
                             pressed(e, "virtual coupling", "press_coupled")};
           },
           judge_sinking,
           {judge_sinking_at_every_tilt}},
          {"S1",
           [](const Evidence& e) {
             return vibrations_beside_shaping(e, "summation", "task2_held", "drill held in the hole",
                                              {"metrics.from_s=0"});
           },
           judge_summation,
           {judge_summation_before}},
          {"B1b", measure_original, judge_original, {judge_original_before}},
          single_case<measure_pop_through, judge_pop_through>("B5", {judge_pop_through_before}),
          single_case<measure_median_line, judge_median_line>("G1"),
          single_case<measure_underestimation, judge_underestimation>("G1b"),
          single_case<measure_depth_cost, judge_depth_cost>("G2"),
          {"B4",
           [](const Evidence& e) {
             return vibrations_beside_shaping(e, "highest_depth", "task2_rotate_signed_distance", "task 2",
                                              {"time.duration_s=6", "record.ideal_trajectory=false"});
           },
           judge_highest_depth,
           {judge_highest_depth_before}},
          single_case<measure_one_direction, judge_one_direction>("C8"),
          single_case<measure_over_reduction, judge_over_reduction>("C1"),
          {"C2", [](const Evidence& e) { return measure_turn_into_wall(e, {}); }, judge_turn_into_wall},
          {"C7",
           [](const Evidence& e) {
             return measure_turn_into_wall(e, {"motion.orientation.tilt_rad.period_s=6", "time.duration_s=6"});
           },
           judge_slow_turn},
          single_case<measure_parallel_faces, judge_parallel_faces>("C3")};
}

}  // namespace hapbench
