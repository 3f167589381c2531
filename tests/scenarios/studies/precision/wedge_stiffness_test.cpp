#include "scenarios/studies/precision/measure.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/registry.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench::wedge_stiffness_test {
namespace {

Scenario wedge_scenario(const std::vector<std::string>& overrides = {}) {
  return load_scenario(find_scenario("wedge_stiffness"), overrides).scenario;
}

PrecisionResult study(const std::vector<std::string>& overrides = {}) {
  PrecisionOptions options;
  options.repetitions = 1;
  return kStiffnessStudy.run(wedge_scenario(overrides), options);
}

enum Column { kHalfAngle, kRatioMin, kRatioMax, kAlong, kAlongFormula, kAcross, kAcrossFormula, kLambdaMax };

/// Compares the rows of the runs with the formulas, of which each algorithm that has one has seven.
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
  EXPECT_THROW(kStiffnessStudy.run(load_scenario(find_scenario("poke_plane"), {}).scenario, {}), InputError);
}

TEST(WedgeStiffness, HasNoFormulaForAlgorithmsItDoesNotKnow) {
  RenderingConfig config;
  config.algorithm = "another";
  EXPECT_FALSE(wedge_stiffness(config, 0.2, 3.0));
}

}  // namespace
}  // namespace hapbench::wedge_stiffness_test
