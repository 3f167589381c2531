#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "scenarios/input/input_error.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::integrators_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionIntegrators, ConvergeWithTheirOrdersToTheExactSolution) {
  const PrecisionResult result = kIntegratorsStudy.run(bundled("springs_oscillation"), quick());
  ASSERT_EQ(result.orders.size(), kIntegrators.size());
  ASSERT_EQ(result.rows.size() % kIntegrators.size(), 0u);
  const std::size_t rows = result.rows.size() / kIntegrators.size();
  // The line is fitted over three decades. The coarsest steps bend it: those of velocity Verlet, whose error of order 2
  // in the springs is still larger there than that of order 1 in the little damping, and those of implicit Euler, which
  // has damped the motion away by then and is as wrong as the motion is large.
  const std::map<const IntegratorEntry*, double> kTolerances = {
      {&kLeapfrog, 0.1}, {&kVelocityVerlet, 0.25}, {&kRk4, 0.1}, {&kImplicitEuler, 0.2}, {&kImplicitMidpoint, 0.05}};
  for (std::size_t i = 0; i < kIntegrators.size(); ++i) {
    const auto tolerance = kTolerances.find(kIntegrators[i]);
    EXPECT_EQ(result.orders[i].series, kIntegrators[i]->info.name);
    EXPECT_NEAR(result.orders[i].order, kIntegrators[i]->damped_order,
                tolerance == kTolerances.end() ? 0.25 : tolerance->second)
        << result.orders[i].series;
    EXPECT_TRUE(result.rows[i * rows].setting.starts_with(result.orders[i].series + " dt="));
  }
  // Leapfrog: a thousand times finer, a thousand times better.
  const double coarse = value(result, 0, "error_rms_m"), fine = value(result, rows - 1, "error_rms_m");
  EXPECT_NEAR(coarse / fine, 1000.0, 500.0);
  EXPECT_LT(fine, 1e-6);
}

TEST(PrecisionIntegrators, TellWhichKeepTheEnergyOfUndampedSprings) {
  const PrecisionResult result = kIntegratorsStudy.run(bundled("springs_oscillation"), quick());
  const std::size_t rows = result.rows.size() / kIntegrators.size();
  const auto first_value = [&](const IntegratorEntry& integrator, const char* column) {
    const auto place = std::find(kIntegrators.begin(), kIntegrators.end(), &integrator) - kIntegrators.begin();
    return value(result, static_cast<std::size_t>(place) * rows, column);
  };
  const auto gain = [&](const IntegratorEntry& i) { return first_value(i, "undamped_energy_gain_relative"); };
  const auto swing = [&](const IntegratorEntry& i) { return first_value(i, "undamped_energy_swing_relative"); };
  // At 1 ms, w dt is at most sqrt(2 K dt^2 / M) = 0.45 (lambda_max = 2). Leapfrog swings by up to w dt / 2 on either
  // side of what it keeps, velocity Verlet by (w dt)^2 / 4; both say so by ending near where they began.
  EXPECT_GT(swing(kLeapfrog), 0.05);
  EXPECT_LT(swing(kLeapfrog), (1.0 + 0.225) / (1.0 - 0.225) - 1.0);
  EXPECT_LT(swing(kVelocityVerlet), 0.05 / (1.0 - 0.05));
  EXPECT_LT(gain(kRk4), 0.0);
  EXPECT_GT(gain(kRk4), -200 * std::pow(0.45, 6) / 72.0);  // (w dt)^6 / 72 a step
  EXPECT_LT(gain(kImplicitEuler), -0.99);
  EXPECT_LT(swing(kImplicitMidpoint), 200 * 20 * std::numeric_limits<double>::epsilon());
}

TEST(PrecisionIntegrators, KeepsARunThatFailsAsARow) {
  // A step of 20 ms is far beyond the stability limit.
  const PrecisionResult result =
      kIntegratorsStudy.run(bundled("springs_oscillation", {"time.step_s=0.02", "time.steps=40"}), quick());
  EXPECT_EQ(result.rows[0].outcome, "diverges");
  EXPECT_TRUE(std::isnan(value(result, 0, "error_rms_m")));
  EXPECT_EQ(result.rows.back().outcome, "completes");
}

TEST(PrecisionIntegrators, RefusesWhatHasNoExactSolution) {
  EXPECT_THROW(kIntegratorsStudy.run(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(kIntegratorsStudy.run(bundled("springs_limited_mean"), quick()), InputError);
  for (const char* nonlinear :
       {"rendering.passivity_controller=true", R"(motion.position={"type":"prescribed","x_m":0,"y_m":0,"z_m":0})"}) {
    EXPECT_THROW(kIntegratorsStudy.run(bundled("single_spring", {nonlinear}), quick()), InputError) << nonlinear;
  }
}

}  // namespace
}  // namespace hapbench::integrators_test
