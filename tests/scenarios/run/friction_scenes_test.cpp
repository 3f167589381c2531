#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/scenarios/support/bundled.hpp"

/// Scenes of dry friction against their closed forms.
namespace hapbench::friction_scenes_test {
namespace {

using test::bundled;
using test::rows_of;

std::string number(const char* field, double value) {
  return std::string(field) + "=" + std::to_string(value);
}

/// Points of the wall stand at y = 0, +-0.1, ... mm, as deep in the peg as their distance from its axis falls short of
/// the radius, and `mean` gives each 1/n: the loads add up to K times their mean depth.
TEST(PegThatJams, SlipsAtMuTimesTheLoadsOfBothWalls) {
  for (const double gap : {0.00085, 0.0009, 0.00096}) {
    double sum = 0.0, n = 0.0;
    for (int i = -5; i <= 5; ++i) {
      const double depth = 0.0005 - std::hypot(0.5 * gap, 1e-4 * i);
      if (depth > 0.0) sum += depth, ++n;
    }
    for (const double mu : {0.1, 0.3, 0.5}) {
      SCOPED_TRACE(testing::Message() << gap << " " << mu);
      const double slips_at = mu * 20000.0 * sum / n / 0.6;  // the push grows by 0.6 N/s
      const auto rows =
          rows_of(bundled("peg_jams_dry", {number("environment.gap_m", gap), number("rendering.friction.mu", mu),
                                           number("time.duration_s", slips_at + 0.05)}));
      double slipped = 0.0;
      for (const StepRecord& row : rows) {
        if (row.force.friction == Friction::slides && slipped == 0.0) slipped = row.time;
      }
      // The bristle's damper bears 0.6 N/s B_t / K_t, less than 1 mN, or 2 ms; with it and a row of the ramp:
      EXPECT_NEAR(slipped, slips_at, 0.003);
      // It creeps by what the bristle gives, mu N / K_t, and then goes.
      const double until = slips_at - 0.005;
      for (const StepRecord& row : rows) {
        if (row.time < until) {
          ASSERT_GE(row.tool.pose.position.z(), -0.004 - mu * sum / n * 1.05) << row.time;
        }
      }
      EXPECT_LT(rows.back().tool.pose.position.z(), -0.004 - 1.1 * mu * sum / n);
    }
  }
}

/// A peg pushed into a taper of the half angle w and let go stays iff mu > sin w / cos^2 w: its loads N push it out by
/// N sin w, and friction, whose P has cos^2 w along the way out, holds mu N cos^2 w. Coulomb on each face would hold
/// from tan w on: the bristle of the whole tool never holds more.
TEST(PegInATaper, LocksItselfFromTheClosedFormOn) {
  for (const double w : {0.1, 0.2, 0.4}) {
    const double locks = std::sin(w) / (std::cos(w) * std::cos(w));
    EXPECT_GT(locks, std::tan(w));
    for (const double factor : {0.97, 1.03}) {
      SCOPED_TRACE(testing::Message() << w << " " << factor);
      const std::string c = std::to_string(std::cos(w)), s = std::to_string(std::sin(w));
      const auto rows = rows_of(bundled(
          "stick_slip_dry",
          {R"(environment={"type":"springs","bilateral":false,"groups":[{"direction":[)" + c + ",0,-" + s +
               R"(],"count":1},{"direction":[-)" + c + ",0,-" + s + R"(],"count":1}]})",
           "initial.position_m=[0,0,0]", "rendering.algorithm=summation", "time.duration_s=1.5",
           number("rendering.friction.mu", factor * locks),
           R"(hand={"type":"force","z_N":{"type":"waypoints","points":[[0,0],[0.3,-5],[0.6,0]],"interpolation":"cosine"}})"}));
      EXPECT_EQ(rows.back().tool.pose.position.z() < -1e-6, factor > 1.0) << rows.back().tool.pose.position.z();
    }
  }
}

/// Drawn by a spring whose end goes at V, the block slips when the spring pulls with mu N, goes by V (1 - cos w t), and
/// so comes to stand every 2 pi sqrt(M/k). Damped by nothing but the bristle while it sticks, it slips on at once: one
/// coefficient of friction has no further rest.
TEST(StickSlip, HasThePeriodOfSpringAndMass) {
  for (const double k : {100.0, 200.0, 400.0}) {
    for (const double mass : {0.05, 0.1}) {
      SCOPED_TRACE(testing::Message() << k << " " << mass);
      const double deep = k * 0.01 / (20000.0 + k), load = 20000.0 * deep, V = 0.01;
      const auto rows =
          rows_of(bundled("stick_slip_dry", {number("hand.stiffness_N_per_m", k), number("rendering.mass_kg", mass),
                                             "initial.position_m=[0,0,-" + std::to_string(deep) + "]"}));
      const double slips_at = 0.3 * load / (k * V), period = 2.0 * std::numbers::pi * std::sqrt(mass / k);
      std::vector<double> stands;
      for (std::size_t i = 1; i + 1 < rows.size(); ++i) {
        const double v = rows[i].tool.velocity.x();
        if (rows[i].time > slips_at + 0.3 * period && v <= rows[i - 1].tool.velocity.x() &&
            v < rows[i + 1].tool.velocity.x())
          stands.push_back(rows[i].time);
        ASSERT_LE(v, 2.05 * V);
      }
      ASSERT_GT(stands.size(), 5u);
      // Each is known to a row; the bristle's give, mu N / K_t of the spring's way mu N / k, shifts the first.
      EXPECT_NEAR(stands.front(), slips_at + period, 0.02 * slips_at + 0.001);
      EXPECT_NEAR((stands.back() - stands.front()) / static_cast<double>(stands.size() - 1), period,
                  0.001 / static_cast<double>(stands.size() - 1) + 1e-4 * period);
      for (const StepRecord& row : rows) {
        if (row.time < 0.98 * slips_at) {
          ASSERT_NE(row.force.friction, Friction::slides) << row.time;
        }
      }
    }
  }
}

}  // namespace
}  // namespace hapbench::friction_scenes_test
