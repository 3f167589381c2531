#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/plugins/load_plugin.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

/// The studies of run time against error, and what they have in common.
namespace hapbench::precision_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(ObservedOrder, OfAPowerIsItsExponent) {
  const std::vector<double> x = {1.0, 0.5, 0.25, 0.125};
  for (const double order : {1.0, 2.0, 4.0}) {
    std::vector<double> error;
    for (const double h : x) error.push_back(3.0 * std::pow(h, order));
    EXPECT_NEAR(observed_order(x, error).value, order, 1e-12);
    EXPECT_NEAR(observed_order(x, error).uncertainty, 0.0, 1e-12);
  }
  EXPECT_TRUE(std::isnan(observed_order(x, std::vector<double>{1.0, 0.0, 0.0, 0.0}).value)) << "one point is no line";
  EXPECT_NEAR(observed_order(x, std::vector<double>{1.0, 0.5, std::nan(""), 0.125}).value, 1.0, 1e-12);
}

TEST(ObservedOrder, IsThatOfTheFineEnd) {
  const std::vector<double> x = {1.0, 0.5, 0.25, 0.125};
  std::vector<double> error;
  for (const double h : x) error.push_back(h + 4.0 * h * h * h);  // looks like third order where it is coarse
  const Order order = observed_order(x, error);
  const auto between = [&](std::size_t i) { return std::log2(error[i] / error[i + 1]); };
  EXPECT_NEAR(order.value, between(2), 1e-12);
  EXPECT_NEAR(order.uncertainty, between(1) - between(2), 1e-12);
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
  // The distance from the formal order falls with the step as its change does, by 2 to 2.5 from one pair to the next;
  // rk4's finest error is only some ten times the rounding that is left out.
  for (std::size_t i = 0; i < kIntegrators.size(); ++i) {
    EXPECT_EQ(result.orders[i].series, kIntegrators[i]->info.name);
    EXPECT_NEAR(result.orders[i].order.value, kIntegrators[i]->damped_order,
                std::max(4.0 * result.orders[i].order.uncertainty, 0.005))
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

TEST(PrecisionTimeStep, OfASpringHasTheOrderOfItsIntegrator) {
  // Leapfrog with damping is of first order, rk4 of fourth; a fit over the coarse steps too is not quite there.
  const PrecisionResult leapfrog = kTimeStepStudy.run(bundled("single_spring"), quick());
  EXPECT_EQ(leapfrog.columns, (std::vector<std::string>{"step_s", "error_final_m", "error_rms_m", "error_max_m"}));
  ASSERT_EQ(leapfrog.rows.size(), 6u);
  EXPECT_NEAR(leapfrog.orders.front().order.value, 1.0, 0.15);
  const PrecisionResult rk4 = kTimeStepStudy.run(bundled("single_spring", {"integrator.type=rk4"}), quick());
  EXPECT_NEAR(rk4.orders.front().order.value, 4.0, 0.4);
  for (std::size_t row = 0; row < 6; ++row) {
    EXPECT_LT(value(rk4, row, "error_max_m"), value(leapfrog, row, "error_max_m"));
  }
}

TEST(PrecisionTimeStep, TakesAMeshAndAPlane) {
  for (const auto& [name, duration] : {std::pair{"poke_plane", "0.1"}, {"mesh_molar", "0.05"}}) {
    const PrecisionResult result =
        kTimeStepStudy.run(bundled(name, {std::string("time.duration_s=") + duration}), quick());
    ASSERT_EQ(result.rows.size(), 6u) << name;
    EXPECT_GT(value(result, 0, "error_rms_m"), value(result, 5, "error_rms_m")) << name;
    EXPECT_GT(value(result, 5, "error_rms_m"), 0.0) << name;
  }
}

TEST(PrecisionTimeStep, OfAPrescribedMotionComparesForces) {
  const PrecisionResult result = kTimeStepStudy.run(bundled("pure_rotation"), quick());
  EXPECT_EQ(result.columns, (std::vector<std::string>{"step_s", "error_final_N", "error_rms_N", "error_max_N"}));
  // The tip stands still, so that nothing but springs acts, which ask for poses alone: the same at common times.
  EXPECT_EQ(value(result, 0, "error_max_N"), 0.0);
}

TEST(PrecisionTimeStep, IsRefusedWhereItMeansNothing) {
  EXPECT_THROW(kTimeStepStudy.run(bundled("vertical_peg_in_hole_shaped_stiffness"), quick()), InputError)
      << "a simulated subject's noise has no limit";
  EXPECT_THROW(kTimeStepStudy.run(bundled("poke_plane", {R"(hand={"type":"none"})"}), quick()), InputError)
      << "no contact";
  EXPECT_THROW(kTimeStepStudy.run(bundled("single_spring", {"time.steps=7"}), quick()), InputError);
  EXPECT_THROW(kTimeStepStudy.run(bundled("single_spring", {"rendering.stiffness_N_per_m=1e12"}), quick()), InputError)
      << "the reference diverges";
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
  ASSERT_EQ(result.rows.size(), algorithms().size() + 7);  // two damped by the turn, five with the passivity controller
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

/// Forces that are sums of continuous depths have slopes; weights that depend on which contacts there are make jumps.
TEST(PrecisionForceJumps, TellAJumpFromASlope) {
  const PrecisionResult result = kForceJumpsStudy.run(bundled("stroke_in_hole"), quick());
  ASSERT_EQ(result.rows.size(), algorithms().size() + 1);  // the default with the reduction, too
  enum Column { kPerMicrometre, kCoarse, kFine, kJump };
  for (const PrecisionRow& row : result.rows) {
    const auto value = [&row](Column column) { return row.values[column].value(); };
    if (row.setting == "summation" || row.setting == "proxy") {
      // Curvature over ten steps of a stroke of 2500: a tenth to a hundredth.
      EXPECT_NEAR(value(kFine), 0.1 * value(kCoarse), 0.01 * 0.1 * value(kCoarse)) << row.setting;
      EXPECT_EQ(value(kJump), 0.0) << row.setting;
    }
    if (row.setting == "proxy") {
      EXPECT_NEAR(value(kPerMicrometre), 0.02, 1e-9) << "one spring of K";
    }
    if (row.setting == "least_squares" || row.setting == "exact_shaping") {
      EXPECT_GT(value(kJump), 0.9 * value(kFine)) << row.setting;
    }
  }
}

TEST(PrecisionForceJumps, RefuseAToolThatForcesMove) {
  EXPECT_THROW(kForceJumpsStudy.run(bundled("poke_plane", {R"(motion.position={"type":"free"})"}), quick()),
               InputError);
}

PrecisionResult study(const std::vector<std::string>& overrides = {}) {
  return kStiffnessStudy.run(bundled("wedge_stiffness", overrides), quick());
}

enum Column { kHalfAngle, kRatioMin, kRatioMax, kAlong, kAlongFormula, kAcross, kAcrossFormula, kLambdaMax };

/// Compares the rows of the runs with the formulas: seven for each algorithm that has one.
void compare_with_formulas(const PrecisionResult& result) {
  int compared = 0;
  for (const PrecisionRow& row : result.rows) {
    if (!row.values[kAlongFormula]) continue;
    // epsilon = 1e-6 pulls the weight C of a face towards zero: C (1 + q + epsilon) = 1, so that 2 C cos^2 w changes by
    // less than 2 epsilon. The others make roundings of numbers below 10, which the angle of at least 10 degrees
    // between the proxy's gradients may divide.
    const bool has_epsilon = row.setting.starts_with("exact_shaping") || row.setting.starts_with("merged_shaping");
    const double tolerance = has_epsilon ? 2.0 * kExactShapingEpsilon : 1e-13;
    EXPECT_NEAR(*row.values[kAlong], *row.values[kAlongFormula], tolerance) << row.setting;
    EXPECT_NEAR(*row.values[kAcross], *row.values[kAcrossFormula], tolerance) << row.setting;
    EXPECT_NEAR(*row.values[kLambdaMax], std::max(*row.values[kAlong], *row.values[kAcross]), tolerance) << row.setting;
    // Either contact sees sin^2 of the one and cos^2 of the other.
    const double s2 = std::pow(std::sin(*row.values[kHalfAngle]), 2);
    const double ratio = s2 * *row.values[kAlongFormula] + (1.0 - s2) * *row.values[kAcrossFormula];
    EXPECT_NEAR(*row.values[kRatioMin], ratio, tolerance) << row.setting;
    EXPECT_NEAR(*row.values[kRatioMax], ratio, tolerance) << row.setting;
    ++compared;
  }
  const auto has_formula = [](const AlgorithmEntry& entry) { return entry.theory.wedge_stiffness != nullptr; };
  EXPECT_EQ(compared, 7 * std::count_if(algorithms().begin(), algorithms().end(), has_formula));
}

TEST(PrecisionStiffness, HasARowForEachAlgorithmAndAngleAndAgreesWithTheClosedForms) {
  const PrecisionResult result = study();
  EXPECT_EQ(result.rows.size(), 7 * algorithms().size());
  compare_with_formulas(result);
}

TEST(PrecisionStiffness, AgreesWithTheClosedFormsOfOtherParameters) {
  compare_with_formulas(study({"rendering.virtual_coupling_N_per_m=5000", "rendering.iterations=0"}));
}

TEST(PrecisionStiffness, RefusesWhatIsNoWedge) {
  const char* direction = R"({"direction": [1, 0, 0], "count": 3})";
  for (const std::string& groups : {std::string("[]"), std::string("[") + direction + "]",
                                    std::string("[") + direction + R"(, {"direction": [0, 1, 0], "count": 2}])"}) {
    EXPECT_THROW(study({"environment.groups=" + groups}), InputError) << groups;
  }
  EXPECT_THROW(kStiffnessStudy.run(bundled("poke_plane"), quick()), InputError);
}

TEST(WedgeStiffness, HasNoFormulaForAlgorithmsItDoesNotKnow) {
  RenderingConfig config;
  config.algorithm = "another";
  EXPECT_FALSE(wedge_stiffness(config, 0.2, 3.0));
}

TEST(PrecisionQueryTime, AsksTheSameQuestionWithAndWithoutTheSearch) {
  const PrecisionResult result = kQueryTimeStudy.run(bundled("cone_in_cone"), quick());
  ASSERT_EQ(result.rows.size() % 2, 0u);
  const std::size_t levels = result.rows.size() / 2;
  for (std::size_t i = 0; i < levels; ++i) {
    SCOPED_TRACE(result.rows[i].setting);
    for (const char* column : {"pushed_m", "depth_max_mean_m", "contacts_mean"}) {
      EXPECT_EQ(value(result, i, column), value(result, levels + i, column)) << column;
    }
    EXPECT_LT(value(result, i, "points_tested_mean"), value(result, levels + i, "points_tested_mean"));
    if (i == 0) continue;
    EXPECT_GT(value(result, i, "depth_max_mean_m"), value(result, i - 1, "depth_max_mean_m"));
  }
  // Face against face, both leaning by 0.5 rad: the way into the cone, measured along the face's normal.
  for (std::size_t i = 0; i < levels; ++i) {
    EXPECT_NEAR(value(result, i, "depth_max_mean_m"), value(result, i, "pushed_m") * std::sin(0.5), 1e-6);
  }
}

TEST(PrecisionQueryTime, NeedsAStroke) {
  EXPECT_THROW(kQueryTimeStudy.run(bundled("rotate_in_hole"), quick()), InputError);
}

}  // namespace
}  // namespace hapbench::precision_test
