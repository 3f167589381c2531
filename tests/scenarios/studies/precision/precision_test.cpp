#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/registry.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/studies/precision/study.hpp"

namespace hapbench {
namespace {

PrecisionOptions quick() {
  PrecisionOptions options;
  options.repetitions = 1;
  return options;
}

Scenario bundled(const std::string& name, std::vector<std::string> overrides = {}) {
  return load_scenario(find_scenario(name), overrides).scenario;
}

double value(const PrecisionResult& result, std::size_t row, const std::string& column) {
  for (std::size_t i = 0; i < result.columns.size(); ++i) {
    if (result.columns[i] == column) return result.rows.at(row).values.at(i).value_or(std::nan(""));
  }
  throw std::invalid_argument(column);
}

TEST(FittedOrder, OfAPowerIsItsExponent) {
  const std::vector<double> x = {1.0, 0.5, 0.25, 0.125};
  for (const double order : {1.0, 2.0, 4.0}) {
    std::vector<double> error;
    for (const double h : x) error.push_back(3.0 * std::pow(h, order));
    EXPECT_NEAR(fitted_order(x, error), order, 1e-12);
  }
  EXPECT_TRUE(std::isnan(fitted_order(x, std::vector<double>{1.0, 0.0, 0.0, 0.0}))) << "one point is no line";
  EXPECT_NEAR(fitted_order(x, std::vector<double>{1.0, 0.5, std::nan(""), 0.125}), 1.0, 1e-12) << "failures left out";
}

TEST(Distance, IsThatOfTheCommonSamples) {
  const std::vector<Vec3> a = {{0, 0, 0}, {3, 4, 0}, {9, 9, 9}}, b = {{0, 0, 1}, {0, 0, 0}};
  const TrajectoryDistance d = distance(a, b);
  EXPECT_EQ(d.final, 5.0);
  EXPECT_EQ(d.max, 5.0);
  EXPECT_NEAR(d.rms, std::sqrt(13.0), 1e-15);
}

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

TEST(PrecisionShaping, IterationsApproachTheExactTensor) {
  const PrecisionResult result = kShapingStudy.run(bundled("task2_rotate_signed_distance"), quick());
  double last = INFINITY;
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    const double error = value(result, row, "tensor_error_rms");
    EXPECT_LT(error, last) << result.rows[row].setting;
    last = error;
  }
  EXPECT_EQ(last, 0.0) << "the exact row is its own reference";
}

TEST(PrecisionReduction, ExactShapingWithoutReductionIsTheReference) {
  const PrecisionResult result = kReductionStudy.run(bundled("task2_rotate_signed_distance"), quick());
  const std::size_t exact_off = result.rows.size() - 1;
  EXPECT_EQ(result.rows[exact_off].setting, "exact_shaping off");
  EXPECT_EQ(value(result, exact_off, "force_error_relative"), 0.0);
  for (std::size_t row = 0; row < exact_off; ++row) {
    EXPECT_GT(value(result, row, "force_error_relative"), 0.0) << result.rows[row].setting;
    EXPECT_LE(value(result, row, "kept_mean"), value(result, exact_off, "kept_mean"));
  }
}

TEST(PrecisionMerging, DependsOnTheOrderOfTheContactsOnlyWhereTheyAreReduced) {
  const PrecisionResult result = kMergingStudy.run(bundled("task2_rotate_signed_distance"), quick());
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    const std::string& setting = result.rows[row].setting;
    const bool reduced = setting.find("reduced") != std::string::npos;
    const double spread = value(result, row, "order_spread_relative");
    if (reduced) {
      EXPECT_GT(spread, 0.1) << setting;
      EXPECT_LT(value(result, row, "kept_mean"), value(result, row, "contacts_mean")) << setting;
    } else {
      // Sums of up to a thousand contacts in another order; exact_shaping knows weights to rounding over epsilon.
      EXPECT_LE(spread, 1e-9) << setting;
      EXPECT_EQ(value(result, row, "kept_mean"), value(result, row, "contacts_mean")) << setting;
    }
  }
  // At every spacing merging is nearer to the exact force than reducing.
  for (std::size_t row = 4; row < result.rows.size(); row += 5) {
    ASSERT_EQ(result.rows[row].setting.find("merged_shaping"), 0u);
    EXPECT_LT(value(result, row, "force_error_relative"), value(result, row - 3, "force_error_relative"));
    EXPECT_LT(value(result, row, "force_error_relative"), value(result, row - 1, "force_error_relative"));
  }
}

TEST(PrecisionSpacing, RefusesAnotherEnvironment) {
  EXPECT_THROW(kSpacingStudy.run(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(kAlgorithmsStudy.run(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(
      kAlgorithmsStudy.run(bundled("drill_in_hole", {"tool.tip=round", "record.ideal_trajectory=false"}), quick()),
      InputError);
}

TEST(PrecisionAlgorithms, HaveARowEachAndTheThesissTwoOneWithAngularDamping) {
  const PrecisionResult result =
      kAlgorithmsStudy.run(bundled("task2_rotate_signed_distance", {"time.duration_s=0.5"}), quick());
  ASSERT_EQ(result.rows.size(), algorithms().size() + 6);  // two damped by the turn, four with the passivity controller
  const auto row_of = [&](const std::string& setting) -> const PrecisionRow& {
    for (const PrecisionRow& row : result.rows) {
      if (row.setting == setting) return row;
    }
    throw std::invalid_argument("no row " + setting);
  };
  // The drill leans towards the wall and back; what is damped at the wall instead of the tip differs.
  EXPECT_NE(row_of("shaped_stiffness").values, row_of("shaped_stiffness + angular_damping").values);
  EXPECT_NO_THROW(row_of("original_averaging + passivity_controller"));
  for (const PrecisionRow& row : result.rows) EXPECT_GT(row.seconds, 0.0) << row.setting;
}

}  // namespace
}  // namespace hapbench
