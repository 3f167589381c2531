#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "scenarios/thesis/claims.hpp"
#include "sim/core/math.hpp"

/// Claims of 2.7, 3.5 and 4.5: the limit of the input force.
namespace hapbench {
namespace {

// ---- L1: displacement into the flat against measured force. deviation: of the displacement without limit from the
// ideal line of Fig. 6, (measured force - weight) / K, rms over the largest one; onset: measured force from which the
// displacement stays [N]; plateau_spread: (max - min) / mean beyond it.

/// Displacement of the tool and of the handle into the flat [m] and measured force [N] of a row with contact.
struct FlatRow {
  double depth, handle, force;
};

std::vector<FlatRow> rows_on_flat(const Evidence& e, const std::string& scenario) {
  const auto table = e.table(scenario, "trajectory.csv");
  std::vector<FlatRow> rows;
  for (std::size_t i = 0; i < table.at("pz_m").size(); ++i) {
    if (table.at("colliding")[i] != 0.0)
      rows.push_back({-table.at("pz_m")[i], -table.at("hz_m")[i], -table.at("fmeas_z_N")[i]});
  }
  return rows;
}

MeasuredValues measure_force_limit(const Evidence& e) {
  const std::vector<FlatRow> off = rows_on_flat(e, "force_limit_off"), on = rows_on_flat(e, "force_limit_on");
  // The plateau is that of the last quarter; the onset where the displacement first reaches 99 % of it.
  double plateau = 0.0, onset = std::numeric_limits<double>::infinity();
  const std::size_t last = on.size() / 4;
  for (std::size_t i = on.size() - last; i < on.size(); ++i) plateau += on[i].depth / static_cast<double>(last);
  for (const auto& [depth, handle, force] : on)
    if (depth >= 0.99 * plateau) onset = std::min(onset, force);
  double low = plateau, high = plateau;
  for (const auto& [depth, handle, force] : on) {
    if (force < onset + 0.2) continue;
    low = std::min(low, depth);
    high = std::max(high, depth);
  }
  const double stiffness = e.load("force_limit_off").scenario.rendering.stiffness;
  double squares = 0.0, deepest = 0.0;
  for (const auto& [depth, handle, force] : off) {
    const double apart = depth - (force - e.published["L1.offset"].mean) / stiffness;
    squares += apart * apart / static_cast<double>(off.size());
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
          fmt::format("{} without the limit; {} with it; {}", proportional ? "proportional" : "not proportional",
                      constant ? "constant" : "not constant", onset ? "onset as published" : "onset elsewhere")};
}

// ---- L4: force over way of the handle, from the first touch to the hardest press [N/m].

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
      fmt::format("{:.2g} times as stiff with the limit; what is left are servo and structure, which are ours", times)};
}

// ---- L2: rows of task 2 in contact in which the hand's force is limited: all, and those whose reaction has reached
// the limit. The reaction grows along v where <v, grad|f|> = -K <f, S v> / |f| > 0; `against` is the share of the rows
// in which it does not, `uphill` how much of the way the tool goes there is uphill. A case for each kind.

Measured measure_saturated_motion(const Evidence& e) {
  // During one rotation of the drill to and fro the hand pushes with more than the input limit of 2 N all the time.
  const LoadedScenario loaded =
      e.load("task2_rotate_signed_distance",
             {R"(hand.force_N={"type":"sine","mean":3.5,"amplitude":1.4,"period_s":1.7})", "time.duration_s=6"});
  const double limit = input_force_limit(loaded.scenario.device).value();
  struct Rows {
    double rows = 0.0, against = 0.0, way = 0.0, uphill = 0.0;
  } all, reached;
  for_each_row(loaded, [&](const StepRecord& row) {
    const Vec3& spring = row.force.spring;
    // The limiter scales the force to the limit, up to rounding.
    if (row.hand.input.norm() < limit * (1.0 - 1e-12) || spring.norm() == 0.0) return;
    const Vec3 gradient = -row.force.S * spring;
    const double along = row.tool.velocity.dot(gradient) / gradient.norm();
    for (Rows* kind : {&all, &reached}) {
      if (kind == &reached && spring.norm() < limit) continue;
      kind->rows += 1.0;
      kind->way += row.tool.velocity.norm();
      if (along <= 0.0) kind->against += 1.0;
      kind->uphill += std::max(0.0, along);
    }
  });
  const auto shares = [](const char* name, const Rows& r) {
    return MeasuredCase{name, {{"rows", {r.rows}}, {"against", {r.against / r.rows}}, {"uphill", {r.uphill / r.way}}}};
  };
  return {shares("all rows at the limit", all), shares("those whose reaction has reached it", reached)};
}

Finding judge_saturated_motion(const Measured& measured, const PublishedNumbers& p) {
  const double nearly_all = threshold(p, "nearly_all");
  const bool always = measured.at(0)["against"] >= nearly_all, reached = measured.at(1)["against"] >= nearly_all;
  return {decide(always, reached),
          always ? "the limit alone keeps the tool from going uphill"
          : reached
              ? "it needs a reaction that has reached the limit: before, the limited force still drives the tool in"
              : "the tool's inertia carries it uphill"};
}

// ---- L3: a tool shaken in free air. A case for each frequency.

constexpr double kNormalShaking = 2.0;  ///< [Hz]
constexpr double kFrequencies[] = {1.0, kNormalShaking, 3.0, 4.0, 6.0, 8.0};

struct Shaking {
  double apparent_mass = 0.0;  ///< amplitude of the hand's force over that of the handle's acceleration [kg]
  double force_max = 0.0;      ///< of the hand, after the first second [N]
};

/// Fundamental components over the last second, which holds whole periods.
Shaking shake(const Evidence& e, double frequency, bool limited) {
  std::vector<std::string> overrides = {fmt::format("hand.target.x_m.period_s={}", 1.0 / frequency)};
  if (!limited) overrides.push_back("device.force_limit_N=null");
  const LoadedScenario loaded = e.load("shaking_in_free_air", overrides);
  const double omega = 2.0 * std::numbers::pi * frequency;
  const double start = loaded.scenario.time.step * static_cast<double>(loaded.scenario.time.steps) - 1.0;
  Eigen::Vector2d force = Eigen::Vector2d::Zero(), position = force;
  Shaking shaking;
  for_each_row(loaded, [&](const StepRecord& row) {
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
          fmt::format("fast shaking {} like more mass; at {} Hz the force {}", heavier ? "feels" : "does not feel",
                      kNormalShaking, normal ? "stays below the limit and nothing changes" : "reaches the limit")};
}

}  // namespace

std::vector<ClaimRule> chapter_3_force_limit() {
  return {
      single_case<measure_force_limit, judge_force_limit>("L1"),
      {"L2", measure_saturated_motion, judge_saturated_motion},
      {"L3", measure_shaking, judge_shaking},
      single_case<measure_felt_stiffness, judge_felt_stiffness>("L4"),
  };
}

}  // namespace hapbench
