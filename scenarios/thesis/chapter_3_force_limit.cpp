#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/force_law.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

/// Claims of thesis sections 2.7, 3.5 and 4.5: the limit of the input force.
namespace hapbench {
namespace {

// ---- L1: displacement of the tool into a flat surface as a function of the measured force.
// deviation: rms difference, without the force limit, between the displacement and the ideal line of Fig. 6,
//   (measured force - weight) / K, divided by the largest displacement.
// onset: smallest measured force [N] at which, with the force limit, the displacement has reached its constant value.
// plateau_spread: (max - min) / mean of the displacement beyond the onset.

/// A step with contact: displacements of the tool (`depth`) and of the handle (`handle`) into the flat surface [m], and
/// the measured force [N].
struct FlatRow {
  double depth, handle, force;
};

/// Returns those steps of a scenario with a flat surface that have a contact. Throws NothingToMeasure if no step has a
/// contact.
std::vector<FlatRow> rows_on_flat(const Evidence& e, const std::string& scenario) {
  const auto table = e.table(scenario, "trajectory.csv");
  std::vector<FlatRow> rows;
  for (std::size_t i = 0; i < table.at("pz_m").size(); ++i)
    if (table.at("colliding")[i] != 0.0)
      rows.push_back({-table.at("pz_m")[i], -table.at("hz_m")[i], -table.at("fmeas_z_N")[i]});
  if (rows.empty()) throw NothingToMeasure(fmt::format("no step of {} has a contact", scenario));
  return rows;
}

MeasuredValues measure_force_limit(const Evidence& e) {
  const std::vector<FlatRow> off = rows_on_flat(e, "force_limit_off"), on = rows_on_flat(e, "force_limit_on");
  // The plateau is the mean displacement in the last quarter of the steps. The onset is the smallest force at which the
  // displacement is at least 99 % of the plateau.
  double plateau = 0.0, onset = std::numeric_limits<double>::infinity();
  const std::size_t last = on.size() / 4;
  for (std::size_t i = on.size() - last; i < on.size(); ++i) plateau += on[i].depth / static_cast<double>(last);
  for (const auto& [depth, handle, force] : on)
    if (depth >= 0.99 * plateau) onset = std::min(onset, force);
  // Find the smallest and the largest displacement at forces that exceed the onset by at least 0.2 N.
  double low = plateau, high = plateau;
  for (const auto& [depth, handle, force] : on) {
    if (force < onset + 0.2) continue;
    low = std::min(low, depth);
    high = std::max(high, depth);
  }
  // Compare the displacement without limit with the ideal line.
  const double stiffness = e.load("force_limit_off").scenario.rendering.stiffness;
  double squares = 0.0, deepest = 0.0;
  for (const auto& [depth, handle, force] : off) {
    const double difference = depth - (force - e.published["L1.offset"].mean) / stiffness;
    squares += difference * difference / static_cast<double>(off.size());
    deepest = std::max(deepest, depth);
  }
  return {
      {"deviation", {std::sqrt(squares) / deepest}}, {"onset", {onset}}, {"plateau_spread", {(high - low) / plateau}}};
}

Finding judge_force_limit(const MeasuredCase& m, const PublishedNumbers& published) {
  const bool proportional = m["deviation"] <= threshold(published, "proportional");
  const bool onset = std::abs(m["onset"] - published["L1.measured"].mean) <= threshold(published, "onset");
  const bool constant = m["plateau_spread"] <= threshold(published, "proportional");
  return {decide(proportional && onset && constant, proportional && constant),
          fmt::format("the displacement is {} without the limit and {} with it; the onset force {} the published force",
                      proportional ? "proportional" : "not proportional", constant ? "constant" : "not constant",
                      onset ? "agrees with" : "differs from")};
}

// ---- L4: stiffness at the handle [N/m]: change of the measured force divided by the displacement of the handle, from
// the first to the last step with contact.

MeasuredValues measure_felt_stiffness(const Evidence& e) {
  MeasuredValues values;
  for (const std::string limit : {"off", "on"}) {
    const std::vector<FlatRow> rows = rows_on_flat(e, "force_limit_" + limit);
    const FlatRow &touch = rows.front(), &hardest = rows.back();
    values[limit] = {(hardest.force - touch.force) / (hardest.handle - touch.handle)};
  }
  return values;
}

Finding judge_felt_stiffness(const MeasuredCase& m, const PublishedNumbers& p) {
  const double times = m["on"] / m["off"];
  return {
      decide(times >= threshold(p, "heavier"), times > 1.0),
      fmt::format("with the limit, the stiffness is {:.2g} times as large; our servo and structure limit the stiffness",
                  times)};
}

// ---- L2: the steps of task 2 with contact in which the hand's force is at the input limit. Measures the magnitude of
// the spring force f (the reaction) [N] in these steps.
// against: fraction of these steps in which |f| does not grow along the velocity v: <v, grad |f|> = -K <f, S v> / |f|
//   <= 0. At the limit the tool is near equilibrium, so that v points in or against the direction of growing |f| by
//   chance. If the tool moves only where the reaction decreases, the reaction does not exceed the limit.
// against_beyond: the same fraction, of the steps in which |f| has reached the limit; NaN without such a step. The
//   earlier rule judged both fractions.

MeasuredValues measure_saturated_motion(const Evidence& e) {
  // The hand pushes with more than the input limit of 2 N while the drill rotates once back and forth.
  const LoadedScenario loaded =
      e.load("task2_rotate_signed_distance",
             {R"(hand.force_N={"type":"sine","mean":3.5,"amplitude":1.4,"period_s":1.7})", "time.duration_s=6"});
  const double limit = input_force_limit(loaded.scenario.device).value();
  std::vector<double> reactions;
  double against = 0.0, beyond = 0.0, against_beyond = 0.0;
  for_each_row(checked(loaded), [&](const StepRecord& row) {
    const Vec3& spring = row.force.spring;
    // Skip steps below the limit. The limiter scales the force to the limit, up to rounding.
    if (row.hand.input.norm() < limit * (1.0 - 1e-12) || spring.norm() == 0.0) return;
    const double moves_against = row.tool.velocity.dot(-row.force.S * spring) <= 0.0 ? 1.0 : 0.0;
    against += moves_against;
    if (spring.norm() >= limit) {
      beyond += 1.0;
      against_beyond += moves_against;
    }
    reactions.push_back(spring.norm());
  });
  if (reactions.empty()) throw NothingToMeasure("no step with contact reaches the limit of the input force");
  const double rows = static_cast<double>(reactions.size());
  std::ranges::sort(reactions);
  const auto quantile = [&](double share) { return reactions[static_cast<std::size_t>(share * (rows - 1.0))]; };
  return {{"rows", {rows}},
          {"limit", {limit}},
          {"median", {quantile(0.5)}},
          {"p99", {quantile(0.99)}},
          {"max", {quantile(1.0)}},
          {"against", {against / rows}},
          {"against_beyond", {against_beyond / beyond}}};
}

Finding judge_saturated_motion(const MeasuredCase& m, const PublishedNumbers& p) {
  const double bound = threshold(p, "around") * m["limit"];
  const bool held = m["p99"] <= bound, median = m["median"] <= bound;
  return {decide(held, median), held ? "the reaction stays near the limit for every force of the hand"
                                     : "the reaction exceeds the limit while the input force is limited"};
}

/// The earlier rule of L2: the tool does not move to a larger reaction.
Verdict judge_direction_of_motion(const Measured& measured, const PublishedNumbers& p) {
  const double nearly_all = threshold(p, "nearly_all");
  return decide(measured.front()["against"] >= nearly_all, measured.front()["against_beyond"] >= nearly_all);
}

// ---- L3: a tool shaken in free air. One case for each frequency.

constexpr double kNormalShaking = 2.0;  ///< [Hz]
constexpr double kFrequencies[] = {1.0, kNormalShaking, 3.0, 4.0, 6.0, 8.0};

/// Result of shaking at one frequency.
struct Shaking {
  double apparent_mass = 0.0;  ///< amplitude of the hand's force divided by amplitude of the handle's acceleration [kg]
  double force_max = 0.0;      ///< largest force of the hand in the last second [N]
};

/// Shakes the tool at a frequency [Hz], with or without the device's force limit. Computes the fundamental components
/// of force and position over the last second, which contains an integer number of periods.
Shaking shake(const Evidence& e, double frequency, bool limited) {
  std::vector<std::string> overrides = {fmt::format("hand.target.x_m.period_s={}", 1.0 / frequency)};
  if (!limited) overrides.emplace_back("device.force_limit_N=null");
  const LoadedScenario loaded = e.load("shaking_in_free_air", overrides);
  const double omega = 2.0 * std::numbers::pi * frequency;
  const double start = loaded.scenario.time.step * static_cast<double>(loaded.scenario.time.steps) - 1.0;
  Eigen::Vector2d force = Eigen::Vector2d::Zero(), position = force;
  Shaking shaking;
  for_each_row(checked(loaded), [&](const StepRecord& row) {
    if (row.time < start) return;
    const Eigen::Vector2d phase(math::cos(omega * row.time), -math::sin(omega * row.time));
    force += row.hand_force.x() * phase;
    position += row.handle.position.x() * phase;
    shaking.force_max = std::max(shaking.force_max, row.hand_force.norm());
  });
  shaking.apparent_mass = force.norm() / (omega * omega * position.norm());
  return shaking;
}

Measured measure_shaking(const Evidence& e) {
  Measured measured;
  for (const double frequency : kFrequencies) {
    const Shaking with = shake(e, frequency, true), without = shake(e, frequency, false);
    measured.push_back({fmt::format("{} Hz", frequency),
                        {{"frequency", {frequency}},
                         {"mass", {with.apparent_mass}},
                         {"mass_unlimited", {without.apparent_mass}},
                         {"force", {with.force_max}}}});
  }
  return measured;
}

Finding judge_shaking(const Measured& measured, const PublishedNumbers& published) {
  const double limit = published["L1.threshold"].mean;
  bool normal = false, heavier = false;
  for (const MeasuredCase& m : measured) {
    const double factor = m["mass"] / m["mass_unlimited"];
    if (m["frequency"] == kNormalShaking)
      normal = m["force"] < limit && std::abs(factor - 1.0) <= threshold(published, "same_mass");
    heavier = heavier || factor >= threshold(published, "heavier");
  }
  return {decide(normal && heavier, heavier),
          fmt::format("fast shaking {} the apparent mass; at {} Hz, {}", heavier ? "increases" : "does not increase",
                      kNormalShaking,
                      normal ? "the force stays below the limit and the apparent mass does not change"
                             : "the force reaches the limit or the apparent mass changes")};
}

}  // namespace

std::vector<ClaimRule> chapter_3_force_limit() {
  return {single_case<measure_force_limit, judge_force_limit>("L1"),
          single_case<measure_saturated_motion, judge_saturated_motion>("L2", {judge_direction_of_motion}),
          {"L3", measure_shaking, judge_shaking},
          single_case<measure_felt_stiffness, judge_felt_stiffness>("L4")};
}

}  // namespace hapbench
