#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/description/parts.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/measurements.hpp"
#include "sim/contact/contact_query.hpp"

/// Claims of 4.2: the depths and gradients of the thesis's two depth models.
/// Claims of chapter 4: what the thesis discusses as limits.
namespace hapbench {
namespace {

// ---- G1: the median line.

constexpr double kSameDirection = 0.999;

Measured measure_median_line(const Evidence&) {
  const auto product = [](const char* model) {
    return wall_point(-0.0001, model).gradient(0).dot(wall_point(0.0001, model).gradient(0));
  };
  return {
      {"", {{"shortest_product", {product("shortest_distance")}}, {"normal_product", {product("surface_normal")}}}}};
}

Finding judge_median_line(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool flips = m["shortest_product"] < 0.0;
  const bool steady = m["normal_product"] > kSameDirection;
  return {
      decide(flips && steady, flips),
      fmt::format("gradients across the median line: inner product {:.2g} (shortest distance), {:.2g} (surface normal)",
                  m["shortest_product"], m["normal_product"]),
      fmt::format("the shortest distance {}, the surface normal {}", flips ? "flips" : "does not flip",
                  steady ? "does not" : "turns, too")};
}

// ---- G1b: by how much the shortest distance falls short of the way out along the surface normal, as a share of that,
// over all contacts of task 2 that are as shallow as the thesis says.

constexpr double kNegligible = 0.05;
/// Rows between samples: about 30 a second.
constexpr std::uint64_t kRowsBetweenSamples = 64;

Measured measure_underestimation(const Evidence& e) {
  const double shallow = e.published["G1.negligible"].at_most;
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance");
  const auto shell = e.shell(loaded);
  const Cylinder tool = make_cylinder(loaded.scenario.tool);
  ShellQuery query(*shell, tool);
  const auto shortest = find_depth_model("surface_normal")->make(),
             exact = find_depth_model("normal_projection")->make();
  ContactBuffer contacts(shell->size());
  std::vector<double> shortfall;
  e.for_each_row(loaded, [&](const StepRecord& row) {
    if (row.step % kRowsBetweenSamples != 0) return;
    query.contacts_at(row.tool.pose, contacts);
    exact->evaluate(tool, row.tool.pose, contacts);
    const std::vector<double> truth(contacts.depth.begin(),
                                    contacts.depth.begin() + static_cast<long>(contacts.size()));
    shortest->evaluate(tool, row.tool.pose, contacts);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (truth[i] > 0.0 && truth[i] <= shallow) shortfall.push_back(1.0 - contacts.depth[i] / truth[i]);
    }
  });
  std::sort(shortfall.begin(), shortfall.end());
  const auto beyond = shortfall.end() - std::upper_bound(shortfall.begin(), shortfall.end(), kNegligible);
  return {{"",
           {{"contacts", {static_cast<double>(shortfall.size())}},
            {"mean", {mean_of(shortfall)}},
            {"percentile_95", {shortfall.at(shortfall.size() * 95 / 100)}},
            {"beyond", {static_cast<double>(beyond) / static_cast<double>(shortfall.size())}}}}};
}

Finding judge_underestimation(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  return {
      decide(m["percentile_95"] <= kNegligible, m["mean"] <= kNegligible),
      fmt::format("{:.0f} contacts of task 2 up to {} mm deep: underestimated by {:.0f} % on average, {:.0f} % at the "
                  "95th percentile, {:.0f} % of them by more than {}",
                  m["contacts"], plain(1e3 * published["G1.negligible"].at_most), 100.0 * m["mean"],
                  100.0 * m["percentile_95"], 100.0 * m["beyond"], percent(kNegligible)),
      "where the tool leans on an edge or across a wall, the way out along the normal is longer than the shortest one"};
}

}  // namespace

std::vector<Claim> chapter_4_depths() {
  return {
      {.id = "G1",
       .place = "4.2, Fig. 8, C.1",
       .claim = "the gradient of the shortest distance flips across the median line, the surface normal's cannot",
       .published = "",
       .rule = "reproduced: one turns round, the other does not; in kind: the first",
       .measure = measure_median_line,
       .judge = judge_median_line},
      {.id = "G1b",
       .place = "4.2, F.1",
       .claim = "depths are underestimated, negligibly when they are small",
       .published = "negligible below <G1.negligible.at_most*1000> mm",
       .rule = fmt::format("reproduced: by at most {} for 95 % of the contacts of task 2; in kind: on average",
                           percent(kNegligible)),
       .measure = measure_underestimation,
       .judge = judge_underestimation},
  };
}

namespace {

// ---- B4: the highest depth along the averaged direction, against stiffness shaping. A case for each in the planar peg
// and in the turn of task 2.

Measured measure_highest_depth(const Evidence& e) {
  Measured measured;
  for (const std::string scene : {"peg_in_hole_2d_frictionless_shaped_stiffness", "task2_rotate_signed_distance"}) {
    for (const std::string algorithm : {"highest_depth", "shaped_stiffness"}) {
      const bool is_peg = scene.starts_with("peg");
      std::vector<std::string> overrides = {"rendering.algorithm=" + algorithm, "rendering.reduction=null",
                                            "record.ratio_iterations=[]"};
      // One rotation to and fro says as much as five.
      if (!is_peg) overrides.insert(overrides.end(), {"time.duration_s=6", "record.ideal_trajectory=false"});
      measured.push_back(
          vibration(algorithm + (is_peg ? ", planar peg" : ", task 2"), e.run(scene, overrides).summary));
    }
  }
  return measured;
}

Finding judge_highest_depth(const Measured& m, const PublishedNumbers&) {
  const bool peg = vibrates_much_more(m.at(0), m.at(1)), task = vibrates_much_more(m.at(2), m.at(3));
  return {decide(peg || task, vibrates_more(m.at(0), m.at(1)) && vibrates_more(m.at(2), m.at(3))), vibrations_text(m),
          fmt::format(
              "the averaged direction turns quickly where gradients cancel: it {} in the planar peg and {} in task 2",
              peg ? "vibrates" : "does not vibrate much more", task ? "vibrates" : "does not vibrate much more")};
}

// ---- C1: over-reduction.

constexpr double kPointsLeft = 1.0;
constexpr double kFewestPoints = 10.0;
constexpr double kForceChange = 0.1;

Measured measure_over_reduction(const Evidence& e) {
  const char *reduced = "over_reduction_reduced", *unreduced = "over_reduction_unreduced";
  const auto a = e.results.table(reduced, "trajectory.csv"), b = e.results.table(unreduced, "trajectory.csv");
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < b.at("fx_N").size(); ++i) {
    const Vec3 with{a.at("fx_N")[i], a.at("fy_N")[i], a.at("fz_N")[i]};
    const Vec3 without{b.at("fx_N")[i], b.at("fy_N")[i], b.at("fz_N")[i]};
    difference = std::max(difference, (with - without).norm());
    largest = std::max(largest, without.norm());
  }
  return {{"",
           {{"reduced_max", {e.results.number(reduced, "metrics.rendered_max")}},
            {"unreduced_max", {e.results.number(unreduced, "metrics.rendered_max")}},
            {"force_difference", {difference / largest}}}}};
}

Finding judge_over_reduction(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool collapsed = m["reduced_max"] == kPointsLeft && m["unreduced_max"] >= kFewestPoints;
  const bool matters = m["force_difference"] >= kForceChange;
  return {decide(collapsed && matters, collapsed),
          fmt::format("{} of {} points left; the force differs by up to {:.0f} %", m["reduced_max"], m["unreduced_max"],
                      100.0 * m["force_difference"]),
          collapsed ? "each point replaces its similar, shallower predecessor until one is left"
                    : "more than one point is left"};
}

// ---- C2: a tool that a hand holds in place and turns into a wall, with the damping of the thesis, which does not see
// the turn, and with one that does.

constexpr double kVibratesMuchMore = 2.0;

Measured measure_turn_into_wall(const Evidence& e) {
  return {vibration("as in the thesis", e.run("turned_into_wall").summary),
          vibration("damping sees the turn", e.run("turned_into_wall_angular_damping").summary)};
}

Finding judge_turn_into_wall(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase &blind = measured.at(0), &seeing = measured.at(1);
  const double more = blind["velocity_variation"] / seeing["velocity_variation"];
  const bool reverses = blind["force_reversals"] > seeing["force_reversals"];
  return {decide(more >= kVibratesMuchMore && reverses, more > 1.0), vibrations_text(measured),
          fmt::format("the tip's velocity varies {:.2g} times as much as with damping that sees the turn", more)};
}

// ---- C3: a drill between two parallel faces.

constexpr double kSinksIn = 0.8;
constexpr double kWeightless = 0.01;

Measured measure_parallel_faces(const Evidence& e) {
  const Scenario scenario = e.load("parallel_faces").scenario;
  const double depth = e.results.number("parallel_faces", "metrics.depth_max_m");
  return {{"",
           {{"depth", {depth}},
            {"radius", {make_cylinder(scenario.tool).radius()}},
            {"force", {e.results.number("parallel_faces", "metrics.force_max_N")}},
            {"one_wall_force", {scenario.rendering.stiffness * depth}}}}};
}

Finding judge_parallel_faces(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool sinks = m["depth"] >= kSinksIn * m["radius"];
  const bool weightless = m["force"] < kWeightless * m["one_wall_force"];
  return {decide(sinks && weightless, weightless),
          fmt::format("sinks in by {:.2f} mm, net force at most {:.2g} N where one wall alone would push with {:.3g} N",
                      1e3 * m["depth"], m["force"], m["one_wall_force"]),
          weightless ? "the forces of the two walls cancel" : "the walls push back"};
}

}  // namespace

std::vector<Claim> chapter_4_discussion() {
  return {
      {.id = "B4",
       .place = "4.1",
       .claim = "taking the highest depth along the averaged direction vibrates in the hole",
       .published = "serious vibration",
       .rule = vibration_rule() + " as with stiffness shaping in the planar peg or in task 2; in kind: more in both",
       .measure = measure_highest_depth,
       .judge = judge_highest_depth},
      {.id = "C1",
       .place = "4.1",
       .claim = "dense points with gradually changing normals collapse to one",
       .published = "one point left",
       .rule = fmt::format("reproduced: {} of at least {} is left and the force changes by at least {}",
                           in_words(kPointsLeft), in_words(kFewestPoints), percent(kForceChange)),
       .measure = measure_over_reduction,
       .judge = judge_over_reduction},
      {.id = "C2",
       .place = "4.4",
       .claim = "turning the tool into a wall is under-damped, since the damping sees the tip's velocity only",
       .published = "",
       .rule = fmt::format(
           "reproduced: the velocity of a tool held in place varies {} times as much as with damping that sees the turn, "
           "and the force reverses more often; in kind: it varies more",
           in_words(kVibratesMuchMore)),
       .measure = measure_turn_into_wall,
       .judge = judge_turn_into_wall},
      {.id = "C3",
       .place = "4.6",
       .claim = "between two parallel faces rotation meets no force",
       .published = "",
       .rule = fmt::format("reproduced: sinks in by {} of the radius, net force below {} of one wall's",
                           percent(kSinksIn), percent(kWeightless)),
       .measure = measure_parallel_faces,
       .judge = judge_parallel_faces},
      {.id = "C4",
       .place = "4.3, C.4.2",
       .claim = "stiffness beyond some value saturates the actuators",
       .published = "about <C4.stiffness.mean*1e-3> 000 or <C4.stiffness.C42.mean*1e-3> 000 N/m",
       .rule = "needs the trainer",
       .measure = [](const Evidence&) { return Measured(); },
       .judge = [](const Measured&, const PublishedNumbers&) -> Finding {
         return {Verdict::not_reproducible, "",
                 "which stiffness saturates the actuators depends on the trainer's mechanics, which are not published"};
       }},
  };
}

}  // namespace hapbench
