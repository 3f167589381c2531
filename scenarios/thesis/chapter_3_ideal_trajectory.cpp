#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "results/io/columns.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/format/parts.hpp"
#include "scenarios/thesis/claims.hpp"

/// Claims of 3.6: the drill turned in the hole against the ideal trajectory.
namespace hapbench {
namespace {

// ---- J1 [m]. A case for each force of a hand that presses with it all the time: taps beyond 2 N would be too short
// for the drill to sink in as far as it does, and the recording of T2 has a single force. At most in kind: the thesis's
// hand and forces are not published. The scene tilts the drill to 0.9 rad: to 1.05 rad the hand of 0.2 N, whose
// direction is constant, slides 1.26 mm off the wall, which 3.2 rules out; the errors of the others then change by less
// than 0.06 mm.

constexpr double kForces[] = {0.2, 0.5, 1.0, 1.5, 1.9, 2.5, 3.5};  ///< [N]

Measured measure_ideal_trajectory(const Evidence& e) {
  Measured measured;
  for (const double force : kForces) {
    const Result run = e.run("task2_held", {fmt::format("hand.force_N={}", force)});
    const std::string hand = force < kGentleForce ? "gentle." : "firm.";
    const auto number = [&](const char* key) -> std::vector<double> {
      return {number_of(run.metrics, "ideal_trajectory." + hand + key).value_or(std::nan(""))};
    };
    measured.push_back({fmt::format("{} N", force),
                        {{"force", {force}},
                         {"height", number("height_error_mean_m")},
                         {"lateral", number("lateral_error_max_m")},
                         {"inside", number("interpenetration_max_m")}}});
  }
  return measured;
}

Finding judge_ideal_trajectory(const Measured& measured, const PublishedNumbers& published) {
  const double around = threshold(published, "around"), split = published["J1.split"].mean;
  const double depth = around * published["J1.depth"].mean, lateral = around * published["J1.lateral"].mean;
  const MeasuredCase& gentlest = measured.front();
  // No number is far off.
  const bool follows = std::abs(gentlest["height"]) <= depth;
  bool on_line = true, above = true, shallow = true;
  std::string as_high;
  for (const MeasuredCase& m : measured) {
    on_line = on_line && m["lateral"] <= lateral;
    shallow = shallow && m["inside"] <= depth;
    if (m["force"] > split) above = above && std::abs(m["height"]) > std::abs(gentlest["height"]);
    if (m["force"] < split && !(std::abs(m["height"]) <= depth)) append_item(as_high, m.name, ", ");
  }
  return {decide(false, follows && on_line && above && shallow), "",
          fmt::format("the gentlest hand {}; {}; the distance to the axis is {}, the depth {}",
                      follows ? "follows" : "is off",
                      as_high.empty() ? "the offset in height starts above 2 N"
                                      : "the height is as far off below 2 N, with " + as_high,
                      on_line ? "as published" : "further off", shallow ? "as published" : "more than published")};
}

// ---- J2: the tilt at which the lower edge of the tip leaves the hole, by bisection.

Measured measure_end_of_contact(const Evidence& e) {
  const Scenario scenario = e.load("task2_held").scenario;
  const BlockWithHole& block = std::get<BlockEnvironment>(scenario.environment).block;
  const double radius = make_cylinder(scenario.tool).radius();
  double touches = 0.6, leaves = 0.5 * std::numbers::pi;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (touches + leaves);
    (ideal_place(block, radius, middle) ? touches : leaves) = middle;
  }
  return {{"", {{"tilt", {touches}}}}};
}

Finding judge_end_of_contact(const Measured& measured, const PublishedNumbers& published) {
  const double tilt = measured.at(0)["tilt"], printed = published["J1.tilt"].at_most;
  const bool same = std::abs(tilt - printed) < 5e-4;  // the printed digits
  return {decide(same, false), "",
          same ? "π / 3 exactly, for a drill of half the hole's diameter" : "another tilt than printed"};
}

}  // namespace

std::vector<ClaimRule> chapter_3_ideal_trajectory() {
  return {
      {"J1", measure_ideal_trajectory, judge_ideal_trajectory},
      {"J2", measure_end_of_contact, judge_end_of_contact},
  };
}

}  // namespace hapbench
