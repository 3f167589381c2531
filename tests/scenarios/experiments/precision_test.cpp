#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/config/bundled_scenarios.hpp"
#include "scenarios/config/load_scenario.hpp"
#include "scenarios/experiments/precision/measure.hpp"
#include "scenarios/experiments/precision/study.hpp"

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

TEST(PrecisionIntegrators, LeapfrogConvergesWithOrderOneToTheExactSolution) {
  const PrecisionResult result = study_integrators(bundled("springs_oscillation"), quick());
  ASSERT_EQ(result.orders.size(), 1u);
  // Symplectic Euler: order 1; the coarsest steps bend the line by a few percent.
  EXPECT_NEAR(result.orders[0].order, 1.0, 0.1);
  // A thousand times finer, a thousand times better.
  const double coarse = value(result, 0, "error_rms_m"), fine = value(result, result.rows.size() - 1, "error_rms_m");
  EXPECT_NEAR(coarse / fine, 1000.0, 500.0);
  EXPECT_LT(fine, 1e-6);
}

TEST(PrecisionIntegrators, KeepsARunThatFailsAsARow) {
  // A step of 20 ms is far beyond the stability limit.
  const PrecisionResult result =
      study_integrators(bundled("springs_oscillation", {"time.step_s=0.02", "time.steps=40"}), quick());
  EXPECT_EQ(result.rows[0].outcome, "diverges");
  EXPECT_TRUE(std::isnan(value(result, 0, "error_rms_m")));
  EXPECT_EQ(result.rows.back().outcome, "completes");
}

TEST(PrecisionIntegrators, RefusesWhatHasNoExactSolution) {
  EXPECT_THROW(study_integrators(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(study_integrators(bundled("springs_limited_mean"), quick()), InputError);
}

TEST(PrecisionShaping, IterationsApproachTheExactTensor) {
  const PrecisionResult result = study_shaping(bundled("task2_rotate_signed_distance"), quick());
  double last = INFINITY;
  for (std::size_t row = 0; row < result.rows.size(); ++row) {
    const double error = value(result, row, "tensor_error_rms");
    EXPECT_LT(error, last) << result.rows[row].setting;
    last = error;
  }
  EXPECT_EQ(last, 0.0) << "the exact row is its own reference";
}

TEST(PrecisionReduction, ExactShapingWithoutReductionIsTheReference) {
  const PrecisionResult result = study_reduction(bundled("task2_rotate_signed_distance"), quick());
  const std::size_t exact_off = result.rows.size() - 1;
  EXPECT_EQ(result.rows[exact_off].setting, "exact_shaping off");
  EXPECT_EQ(value(result, exact_off, "force_error_relative"), 0.0);
  for (std::size_t row = 0; row < exact_off; ++row) {
    EXPECT_GT(value(result, row, "force_error_relative"), 0.0) << result.rows[row].setting;
    EXPECT_LE(value(result, row, "kept_mean"), value(result, exact_off, "kept_mean"));
  }
}

TEST(PrecisionSpacing, RefusesAnotherEnvironment) {
  EXPECT_THROW(study_spacing(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(study_algorithms(bundled("poke_plane"), quick()), InputError);
}

TEST(PrecisionAlgorithms, HaveARowEach) {
  const PrecisionResult result =
      study_algorithms(bundled("task2_rotate_signed_distance", {"time.duration_s=0.5"}), quick());
  EXPECT_EQ(result.rows.size(), algorithms().size() + 4);  // four of them with the passivity controller too
  for (const PrecisionRow& row : result.rows) EXPECT_GT(row.seconds, 0.0) << row.setting;
}

}  // namespace
}  // namespace hapbench
