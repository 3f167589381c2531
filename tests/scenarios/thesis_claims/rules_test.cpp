#include "scenarios/thesis_claims/rules.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

/// Every rule with numbers made up to pass and numbers made up to fail.
namespace hapbench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

void expect_verdict(const Finding& finding, Verdict verdict) {
  EXPECT_EQ(finding.verdict, verdict) << finding.measured << " / " << finding.why;
  EXPECT_FALSE(finding.measured.empty());
  EXPECT_FALSE(finding.why.empty());
}

TEST(ClaimRules, T1FlatReduction) {
  expect_verdict(judge_flat_reduction({{"a", 40, 1, 1}, {"b", 40, 1, 1}}), Verdict::reproduced);
  expect_verdict(judge_flat_reduction({{"a", 40, 1, 1}, {"b", 40, 1.1, 2}}), Verdict::not_reproduced);
}

TEST(ClaimRules, T2AndT3ReducedPoints) {
  const std::vector<Published> published = {{6.2, 1.7}, {5.5, 1.9}};
  expect_verdict(judge_reduced_points({{"a", 40, 15, 30}, {"b", 40, 7.8, 12}}, published, 0), Verdict::reproduced);
  expect_verdict(judge_reduced_points({{"a", 40, 15, 30}, {"b", 40, 8.0, 12}}, published, 0), Verdict::in_kind);
  expect_verdict(judge_reduced_points({{"a", 40, 21, 30}, {"b", 40, 8.0, 12}}, published, 0), Verdict::not_reproduced);
  expect_verdict(judge_reduced_points({{"a", 40, 6, 15}}, published, 15), Verdict::in_kind);
  expect_verdict(judge_reduced_points({{"a", 40, 6, 14}}, published, 15), Verdict::reproduced);
}

TEST(ClaimRules, T4Deadline) {
  expect_verdict(judge_deadline(1.3e-3, 5e-6, 2e-6, 5e-4), Verdict::reproduced);
  expect_verdict(judge_deadline(3e-4, 5e-6, 2e-6, 5e-4), Verdict::in_kind);
  expect_verdict(judge_deadline(1.3e-3, 6e-4, 2e-6, 5e-4), Verdict::not_reproduced);
}

TEST(ClaimRules, R1FirstRatios) {
  expect_verdict(judge_first_ratios({0.81, 1.29, 1.4, 1.1, 1.1}, 0.8, 1.3, 1.5), Verdict::reproduced);
  expect_verdict(judge_first_ratios({0.79, 1.29, 1.4, 1.1, 1.1}, 0.8, 1.3, 1.5), Verdict::in_kind);
  expect_verdict(judge_first_ratios({0.81, 1.29, 1.51, 1.1, 1.1}, 0.8, 1.3, 1.5), Verdict::not_reproduced);
}

TEST(ClaimRules, R1bRatioLimit) {
  expect_verdict(judge_ratio_limit({1, 1, 1, 1.005, 1.009}), Verdict::reproduced);
  expect_verdict(judge_ratio_limit({1, 1, 1, 1.3, 1.3}), Verdict::refuted);
}

TEST(ClaimRules, L1ForceLimit) {
  expect_verdict(judge_force_limit({1.01, 2.75, 0.01}, 2.7), Verdict::reproduced);
  expect_verdict(judge_force_limit({1.01, 2.0, 0.01}, 2.7), Verdict::in_kind);
  expect_verdict(judge_force_limit({1.01, kNever, 0.5}, 2.7), Verdict::not_reproduced);
  expect_verdict(judge_force_limit({0.5, 2.7, 0.01}, 2.7), Verdict::not_reproduced);
}

TEST(ClaimRules, J1IdealTrajectory) {
  expect_verdict(judge_ideal_trajectory({2e-4, 1e-4, 1e-5, 1e-4, 2.4e-4}, 2.5e-4), Verdict::reproduced);
  expect_verdict(judge_ideal_trajectory({2e-4, 1e-4, 1e-5, 3e-4, 9e-4}, 2.5e-4), Verdict::in_kind);
  expect_verdict(judge_ideal_trajectory({7e-4, 1e-4, 1e-5, 1e-4, 2.4e-4}, 2.5e-4), Verdict::not_reproduced);
}

TEST(ClaimRules, A1PegMotion) {
  expect_verdict(judge_peg_motion({3.0, 40}, {0.1, 6}), Verdict::reproduced);
  expect_verdict(judge_peg_motion({0.2, 40}, {0.1, 6}), Verdict::in_kind);
  expect_verdict(judge_peg_motion({0.1, 40}, {0.2, 6}), Verdict::not_reproduced);
}

TEST(ClaimRules, A2SpringsUnlimited) {
  const SpringRun good{"good", true, 0.0, 0.1}, bad{"bad", false, 9.0, kNever};
  expect_verdict(judge_springs_unlimited({good, good, good}), Verdict::reproduced);
  expect_verdict(judge_springs_unlimited({good, good, bad}), Verdict::in_kind);
  expect_verdict(judge_springs_unlimited({good, bad, bad}), Verdict::not_reproduced);
}

TEST(ClaimRules, A3SpringsLimited) {
  const std::vector<SpringRun> before = {{"hs", true, 0, 0.020}, {"other", true, 0, 0.020}};
  const auto after = [](double hs, double other) {
    return std::vector<SpringRun>{{"hs", true, 0, hs}, {"other", true, 0, other}};
  };
  expect_verdict(judge_springs_limited(before, after(0.021, 0.031), "hs"), Verdict::reproduced);
  expect_verdict(judge_springs_limited(before, after(0.021, kNever), "hs"), Verdict::reproduced);
  expect_verdict(judge_springs_limited(before, after(0.021, 0.021), "hs"), Verdict::in_kind);
  expect_verdict(judge_springs_limited(before, after(0.030, 0.031), "hs"), Verdict::not_reproduced);
}

TEST(ClaimRules, A4StabilityLimits) {
  expect_verdict(judge_stability_limits({{"a", 1.01, 1.0}, {"b", 399, 400}}), Verdict::reproduced);
  expect_verdict(judge_stability_limits({{"a", 1.1, 1.0}}), Verdict::in_kind);
  expect_verdict(judge_stability_limits({{"a", 1.3, 1.0}}), Verdict::not_reproduced);
}

TEST(ClaimRules, B1FlippedGradient) {
  expect_verdict(judge_flipped_gradient(-1, 1), Verdict::reproduced);
  expect_verdict(judge_flipped_gradient(-1, -1), Verdict::in_kind);
  expect_verdict(judge_flipped_gradient(1, 1), Verdict::not_reproduced);
}

TEST(ClaimRules, B2OriginalDamping) {
  expect_verdict(judge_original_damping(0.25, 0, 60), Verdict::reproduced);
  expect_verdict(judge_original_damping(0.75, 0, 30), Verdict::in_kind);
  expect_verdict(judge_original_damping(1.0, 0, 0), Verdict::not_reproduced);
}

TEST(ClaimRules, B3AddedPoints) {
  expect_verdict(judge_added_points(21, 23, -1, 10), Verdict::reproduced);
  expect_verdict(judge_added_points(21, 22, -1, 10), Verdict::in_kind);
  expect_verdict(judge_added_points(21, 23, 1, 10), Verdict::not_reproduced);
}

TEST(ClaimRules, G1MedianLine) {
  expect_verdict(judge_median_line(-1, 1, 0.03), Verdict::reproduced);
  expect_verdict(judge_median_line(-1, 1, 0.2), Verdict::in_kind);
  expect_verdict(judge_median_line(1, 1, 0.03), Verdict::not_reproduced);
}

TEST(ClaimRules, C1OverReduction) {
  expect_verdict(judge_over_reduction(1, 100, 0.5), Verdict::reproduced);
  expect_verdict(judge_over_reduction(1, 100, 0.01), Verdict::in_kind);
  expect_verdict(judge_over_reduction(2, 100, 0.5), Verdict::not_reproduced);
}

TEST(ClaimRules, C2PureRotation) {
  expect_verdict(judge_pure_rotation(1e-3, 0.0), Verdict::reproduced);
  expect_verdict(judge_pure_rotation(1e-3, -1e-6), Verdict::in_kind);
  expect_verdict(judge_pure_rotation(0.0, 0.0), Verdict::not_reproduced);
}

TEST(ClaimRules, C3ParallelFaces) {
  expect_verdict(judge_parallel_faces(5e-4, 5e-4, 0.05, 10), Verdict::reproduced);
  expect_verdict(judge_parallel_faces(1e-4, 5e-4, 0.05, 10), Verdict::in_kind);
  expect_verdict(judge_parallel_faces(5e-4, 5e-4, 1.0, 10), Verdict::not_reproduced);
}

TEST(ClaimRules, F1NormalProjection) {
  expect_verdict(judge_normal_projection(7, 0.3, 8e-4, 8e-4, 5e-4), Verdict::reproduced);
  expect_verdict(judge_normal_projection(7, 0.3, 8e-4, 5e-4, 5e-4), Verdict::in_kind);
  expect_verdict(judge_normal_projection(1, 0.3, 8e-4, 8e-4, 5e-4), Verdict::not_reproduced);
}

TEST(ClaimRules, F2Tandpasta) {
  expect_verdict(judge_tandpasta(1.0, 5, 500), Verdict::reproduced);
  expect_verdict(judge_tandpasta(1.1, 5, 500), Verdict::in_kind);
  expect_verdict(judge_tandpasta(1.1, 400, 500), Verdict::not_reproduced);
}

TEST(PairedT, IsTheMeanDifferenceOverItsStandardError) {
  // Differences 1, 2, 3: mean 2, standard deviation 1.
  EXPECT_NEAR(paired_t({2, 4, 6}, {1, 2, 3}), 2.0 * std::sqrt(3.0), 1e-14);
  EXPECT_EQ(paired_t({0, 0, 0}, {1, 1, 1}), -kNever) << "all pairs differ alike";
  EXPECT_EQ(paired_t({1, 2}, {1, 2}), 0.0);
  EXPECT_EQ(paired_t({1}, {2}), 0.0) << "one pair says nothing";
}

PairedMeasure rate(std::vector<double> original, std::vector<double> shaped) {
  return {"success rate", std::move(original), std::move(shaped), {0.3, 0.1}, {0.95, 0.05}};
}
PairedMeasure speed(std::vector<double> original, std::vector<double> shaped) {
  return {"speed", std::move(original), std::move(shaped), {0.009, 0.001}, {0.002, 0.0001}};
}

TEST(ClaimRules, D1ToD4Experiments) {
  const PairedMeasure better = rate({0.2, 0.3, 0.4}, {0.9, 1.0, 1.0}), alike = rate({0.5, 0.6, 0.4}, {0.6, 0.4, 0.5});
  const PairedMeasure slower = speed({9e-3, 8e-3, 8.5e-3}, {2e-3, 2e-3, 2e-3}),
                      faster = speed({1, 1.1, 0.9}, {2, 2, 2});
  expect_verdict(judge_experiment({better, slower}, true), Verdict::reproduced);
  expect_verdict(judge_experiment({better, faster}, true), Verdict::in_kind);
  expect_verdict(judge_experiment({alike, slower}, true), Verdict::not_reproduced);
  expect_verdict(judge_experiment({rate({0.9, 1.0, 1.0}, {0.2, 0.3, 0.4}), slower}, true), Verdict::not_reproduced);
  expect_verdict(judge_experiment({better}, false), Verdict::not_reproduced);
  PairedMeasure even = alike;
  even.published_original = even.published_shaped = {0.5, 0.1};
  expect_verdict(judge_experiment({even}, false), Verdict::reproduced);
}

TEST(VerdictName, IsThatOfTheLedger) {
  EXPECT_EQ(verdict_name(Verdict::reproduced), "reproduced");
  EXPECT_EQ(verdict_name(Verdict::in_kind), "reproduced in kind");
  EXPECT_EQ(verdict_name(Verdict::not_reproduced), "not reproduced");
  EXPECT_EQ(verdict_name(Verdict::refuted), "refuted");
  EXPECT_EQ(verdict_name(Verdict::not_reproducible), "not reproducible");
}

}  // namespace
}  // namespace hapbench
