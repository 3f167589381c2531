#include "scenarios/analysis/convergence/observed_order.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/scene/metric_sections.hpp"

/// Tests observed orders of sequences with known order, and of sequences without an order. tests/known_answers tests
/// Roache's formulas on a recurrence.

namespace hapbench::observed_order_test {
namespace {

/// Returns `count` levels h = 1, 1/ratio, 1/ratio^2, … with the results f(h).
std::vector<LevelResult> levels_of(const std::function<double(double)>& f, std::size_t count = 5, double ratio = 2.0) {
  std::vector<LevelResult> levels;
  double h = 1.0;
  for (std::size_t i = 0; i < count; ++i, h /= ratio)
    levels.push_back({"h = " + std::to_string(h), "completes", f(h), {}, i});
  return levels;
}

std::vector<LevelResult> levels_with(const std::vector<double>& results) {
  std::vector<LevelResult> levels;
  for (const double result : results)
    levels.push_back({"level " + std::to_string(levels.size()), "completes", result, {}, levels.size()});
  return levels;
}

Convergence judged(const std::vector<LevelResult>& levels, double formal_order, double ratio = 2.0) {
  return convergence_of({{}, ratio, formal_order}, levels);
}

/// Checks that there is no order, that the reason contains the text `expected`, and that numbers that require an order
/// are empty.
void expect_no_order(const Convergence& c, const std::string& expected) {
  EXPECT_NE(c.reason.find(expected), std::string::npos) << c.reason;
  EXPECT_FALSE(c.order || c.extrapolated || c.gci || c.asymptotic) << c.reason;
}

TEST(ObservedOrder, IsThatOfAPureErrorTerm) {
  for (const double p : {0.5, 1.0, 2.0, 4.0}) {
    for (const double ratio : {1.5, 2.0, 10.0}) {
      const Convergence c =
          judged(levels_of([p](double h) { return 3.0 - 0.25 * std::pow(h, p); }, 3, ratio), 4.0, ratio);
      ASSERT_TRUE(c.order) << p << " " << ratio << ": " << c.reason;
      // The difference of two results near 3 has a rounding error of 2 * 3 * 2.2e-16. The smallest difference is
      // 2.5e-5, at p = 4 and ratio = 10.
      EXPECT_NEAR(*c.order, p, 1e-6);
      EXPECT_NEAR(*c.extrapolated, 3.0, 1e-13);
      // The expected error of the finest level, with Roache's factor.
      const double error = 0.25 * std::pow(ratio, -2.0 * p);
      EXPECT_NEAR(*c.gci, 1.25 * error / (3.0 - error), 1e-6 * error + 1e-13);
      EXPECT_NEAR(*c.errors.back(), 1.25 * error, 1e-6 * error + 1e-13);
      EXPECT_NEAR(*c.errors.front(), 1.25 * 0.25, 1e-12);
    }
  }
}

TEST(ObservedOrder, IsAsymptoticWhereTheIndicesAgreeWithinATenth) {
  EXPECT_TRUE(judged(levels_with({1.5, 1.1, 1.0}), 2.0).asymptotic) << "f_3 / f_2 = 1 / 1.1";
  EXPECT_FALSE(judged(levels_with({1.6, 1.2, 1.0}), 2.0).asymptotic) << "1 / 1.2";
}

TEST(ObservedOrder, IsNotStatedWhereTheDifferencesShowNone) {
  const double ulp = std::nextafter(1.0, 2.0) - 1.0;
  const std::pair<std::vector<double>, const char*> kCases[] = {
      {{1.0, 1.2, 1.1, 1.15, 1.125}, "change sign"},
      {{2.0, 1.0, 1.4, 1.2, 1.1}, "change sign"},  // the last three results alone would have order 1
      {{1.0, 1.1, 1.3, 1.7}, "do not shrink"},
      {{1.0, 1.1, 1.2, 1.3}, "do not shrink"},
      {{1.0, 1.01, 1.2, 1.344}, "do not shrink"},  // the last three results alone would have order 0.4
      {{2.0, 1.125, 1.015625, 1.001953125}, "more than twice the formal order 1"},
      {{2.0, 2.0, 2.0}, "rounding"},
      {{0.0, 0.0, 0.0}, "rounding"},
      {{1.1, 1.0 + 16 * ulp, 1.0 + 4 * ulp, 1.0 + 2 * ulp, 1.0 + ulp}, "rounding"},
      {{1.0, 2.0, 2.0, 3.0, 3.5}, "some of the last levels"}};
  for (const auto& [results, expected] : kCases) expect_no_order(judged(levels_with(results), 1.0), expected);
}

TEST(ObservedOrder, IsNotStatedWhereContactsSwitch) {
  std::vector<LevelResult> levels = levels_of([](double h) { return 1.0 + h; });
  for (LevelResult& level : levels) level.contacts = {{"landings", 1.0}, {"colliding_mean", 21.0}};
  levels[1].contacts[1].second = 22.0;
  EXPECT_TRUE(judged(levels, 1.0).order) << "the coarse levels do not count";
  levels[4].contacts[1].second = 21.5;
  const Convergence c = judged(levels, 1.0);
  expect_no_order(c, "contacts change between the last 3 levels (colliding_mean is 21 at");
  EXPECT_EQ(c.band, std::pair(1.0625, 1.25));
  EXPECT_NEAR(*c.errors[0], 1.0 - 0.0625, 1e-12);
}

TEST(ObservedOrder, CountsLevelsThatEndAsTheFinest) {
  std::vector<LevelResult> levels = levels_of([](double h) { return 1.0 + h; });
  levels[0] = {"h = 1", "diverges", std::nullopt};
  levels[1].outcome = "went_through";
  const Convergence c = judged(levels, 1.0);
  ASSERT_TRUE(c.order) << c.reason;
  EXPECT_NEAR(*c.extrapolated, 1.0, 1e-12);
  EXPECT_FALSE(c.errors[0] || c.errors[1] || !c.errors[2]);
  levels[2].result.reset();
  const Convergence two = judged(levels, 1.0);
  expect_no_order(two, "the run at h = 0.250000 has no value of the metric (outcome completes), which leaves 2 levels");
  EXPECT_EQ(two.band, std::pair(1.0625, 1.125));
  levels[4].outcome = "stuck";
  expect_no_order(judged(levels, 1.0), "has the outcome completes, which leaves 1 levels");
  EXPECT_FALSE(judged(levels, 1.0).band);
  levels[4].result.reset();
  const Convergence none = judged(levels, 1.0);
  expect_no_order(none, "the finest run, at h = 0.062500, has no value of the metric (outcome stuck)");
  for (const auto& error : none.errors) EXPECT_FALSE(error);
  expect_no_order(judged(levels_with({1.0, 2.0}), 1.0), "three levels are needed, got 2");
}

constexpr MetricTraits kExtreme{.smooth = false, .either_sign = false};

/// Checks results like the speed before a landing. Over some levels, their error decreases as at first order, until the
/// landing moves to another step.
TEST(ObservedOrder, OfExtremesNeedsFiveLevelsAndCountsTheirScatter) {
  const std::vector<double> halving = {1.0 + 1.0 / 4, 1.0 + 1.0 / 8, 1.0 + 1.0 / 16, 1.0 + 1.0 / 32, 1.0 + 1.0 / 64};
  for (const std::size_t count : {std::size_t{3}, std::size_t{4}}) {
    std::vector<LevelResult> levels = levels_with({halving.begin(), halving.begin() + static_cast<long>(count)});
    levels.back().spread = 0.5;
    const Convergence c = convergence_of({{}, 2.0, 1.0}, levels, kExtreme);
    expect_no_order(c, "needs five levels");
    // The errors include the spread, and the difference that levels beyond the finest level would add at first order.
    // Here the limit of the results is 1.
    EXPECT_NEAR(*c.errors.front(), halving.front() - 1.0 + 0.5, 1e-12) << count;
    EXPECT_NEAR(c.band->first, halving[count - 1] - 0.5, 1e-12);
    EXPECT_NEAR(c.band->second, halving[count - 3] + 0.5, 1e-12);
  }
  std::vector<LevelResult> levels = levels_with(halving);
  const Convergence five = convergence_of({{}, 2.0, 1.0}, levels, kExtreme);
  ASSERT_TRUE(five.order) << five.reason;
  EXPECT_NEAR(*five.extrapolated, 1.0, 1e-12);
  EXPECT_NEAR(*five.errors.back(), 1.0 / 16 - 1.0 / 64, 1e-12) << "at least the range of the last three levels";
  levels.back().spread = 0.5;
  EXPECT_NEAR(*convergence_of({{}, 2.0, 1.0}, levels, kExtreme).errors.back(), 0.5 + 1.0 / 16 - 1.0 / 64, 1e-12);
  // All five levels must agree, not only four of them.
  levels.front().result = 0.9;
  EXPECT_TRUE(judged(levels, 1.0).order);
  expect_no_order(convergence_of({{}, 2.0, 1.0}, levels, kExtreme), "change sign");
}

/// Checks the errors of a first-order extreme, whose limit is 1, with a small ratio of the levels. Without the division
/// by r - 1, the error of the finest level would be 0.64 of the true error.
TEST(ObservedOrder, OfExtremesCountsAllFurtherLevelsAtASmallRatio) {
  const double r = 1.2;
  const std::vector<double> results = {1.0 + 1.0, 1.0 + 1.0 / r, 1.0 + 1.0 / (r * r)};
  const Convergence c = convergence_of({{}, r, 1.0}, levels_with(results), kExtreme);
  expect_no_order(c, "needs five levels");
  // Rounding: results of about 1 with 1e-16, divided by r - 1.
  EXPECT_NEAR(*c.errors.front(), results.front() - 1.0, 1e-14);
  EXPECT_GE(*c.errors.back(), results.back() - 1.0);
}

TEST(ObservedOrder, OfAMetricThatCannotBeNegativeLeadsToNoNegativeValue) {
  const std::vector<LevelResult> levels = levels_with({0.9, 0.5, 0.2});
  const MetricTraits rms{.smooth = true, .either_sign = false}, position{.smooth = true, .either_sign = true};
  expect_no_order(convergence_of({{}, 2.0, 1.0}, levels, rms), "the extrapolated value -0.7 is negative");
  EXPECT_NEAR(*convergence_of({{}, 2.0, 1.0}, levels, position).extrapolated, -0.7, 1e-12);
}

TEST(ObservedOrder, MayExceedTwiceTheFormalOrderByWhatAsymptoticLevelsMay) {
  // The ratios d_1 / d_2 of the differences are 2^2 * 1.05 and 2^2 * 1.15. The asymptotic range allows a factor of 1.1.
  EXPECT_TRUE(judged(levels_with({1.0 + 0.42 + 0.1, 1.0 + 0.1, 1.0}), 1.0).order);
  expect_no_order(judged(levels_with({1.0 + 0.46 + 0.1, 1.0 + 0.1, 1.0}), 1.0), "more than twice the formal order 1");
}

TEST(ObservedOrder, TraitsAreThoseOfTheMetric) {
  const MetricList& all = all_metrics();
  for (const char* name : {"force_max_N", "speed_max_m_per_s", "force_step_p99_N", "landing_force_max_N", "landings",
                           "force_mean_in_contact_N", "ratio_min", "unknown"}) {
    EXPECT_FALSE(traits_of(all, name).smooth) << name;
    EXPECT_FALSE(traits_of(all, name).either_sign) << name;
  }
  for (const char* name : {"final_position_m.z", "energy.damping_J", "passivity.energy_end_J"}) {
    EXPECT_TRUE(traits_of(all, name).smooth) << name;
    EXPECT_TRUE(traits_of(all, name).either_sign) << name;
  }
  EXPECT_TRUE(traits_of(all, "vibration_power_above_30Hz_m2_per_s2").smooth);
  EXPECT_FALSE(traits_of(all, "vibration_power_above_30Hz_m2_per_s2").either_sign);
  EXPECT_TRUE(traits_of(all, "passivity.energy_min_J").either_sign);
}

}  // namespace
}  // namespace hapbench::observed_order_test
