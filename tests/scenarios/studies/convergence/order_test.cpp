#include "scenarios/studies/convergence/order.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/scenarios/support/scenarios.hpp"

/// Observed orders of sequences whose order is known, and of such as have none.
namespace hapbench::order_test {
namespace {

/// Levels h = 1, 1/r, … of a result f(h).
std::vector<LevelResult> levels_of(const std::function<double(double)>& f, std::size_t count = 5, double ratio = 2.0) {
  std::vector<LevelResult> levels;
  double h = 1.0;
  for (std::size_t i = 0; i < count; ++i, h /= ratio) levels.push_back({"h = " + std::to_string(h), "completes", f(h)});
  return levels;
}

std::vector<LevelResult> levels_with(const std::vector<double>& results) {
  std::vector<LevelResult> levels;
  for (const double result : results) levels.push_back({"level " + std::to_string(levels.size()), "completes", result});
  return levels;
}

/// No order, for a reason with these words; and then none of the numbers that only an order gives.
void expect_no_order(const Convergence& c, const std::string& said) {
  EXPECT_NE(c.reason.find(said), std::string::npos) << c.reason;
  EXPECT_FALSE(c.order || c.extrapolated || c.gci || c.asymptotic) << c.reason;
}

TEST(ObservedOrder, IsThatOfAPureErrorTerm) {
  for (const double p : {0.5, 1.0, 2.0, 4.0}) {
    for (const double ratio : {1.5, 2.0, 10.0}) {
      const Convergence c =
          convergence_of(levels_of([p](double h) { return 3.0 - 0.25 * std::pow(h, p); }, 3, ratio), ratio, 4.0);
      ASSERT_TRUE(c.order) << p << " " << ratio << ": " << c.reason;
      // The differences are known to 3 * 2.2e-16 * 2; the smallest of them is 0.25 (10^-1 - 10^-2)^... = 2e-9 at p = 4.
      EXPECT_NEAR(*c.order, p, 1e-6);
      EXPECT_NEAR(*c.extrapolated, 3.0, 1e-13);
      // The error of the finest level, with Roache's factor.
      const double error = 0.25 * std::pow(ratio, -2.0 * p);
      EXPECT_NEAR(*c.gci, 1.25 * error / (3.0 - error), 1e-6 * error + 1e-13);
      EXPECT_NEAR(*c.errors.back(), 1.25 * error, 1e-6 * error + 1e-13);
      EXPECT_NEAR(*c.errors.front(), 1.25 * 0.25, 1e-12);
    }
  }
}

/// Roache's own numbers, 1.25 |f_3 - f_2| / (|f_3| (r^p - 1)) and f_3 + (f_3 - f_2) / (r^p - 1), by hand: differences
/// 0.4 and 0.1 are of the second order, and 0.1 / 3 is left.
TEST(ObservedOrder, FollowsTheFormulas) {
  const Convergence c = convergence_of(levels_with({1.5, 1.1, 1.0}), 2.0, 2.0);
  EXPECT_NEAR(*c.order, 2.0, 1e-12);
  EXPECT_NEAR(*c.extrapolated, 1.0 - 0.1 / 3.0, 1e-12);
  EXPECT_NEAR(*c.gci, 1.25 * 0.1 / 3.0, 1e-12);
  ASSERT_EQ(c.orders.size(), 3u);
  EXPECT_FALSE(c.orders[0] || c.orders[1]);
  EXPECT_EQ(c.orders[2], c.order);
  EXPECT_EQ(c.band, std::pair(1.0, 1.5));
  // f_3 / f_2 = 1 / 1.1 is within 0.1 of 1.
  EXPECT_TRUE(c.asymptotic);
  EXPECT_FALSE(convergence_of(levels_with({1.6, 1.2, 1.0}), 2.0, 2.0).asymptotic) << "1 / 1.2 is not";
}

TEST(ObservedOrder, IsAsymptoticWhereTheLevelsBeforeAgree) {
  // A second term half as large at h = 1: at the last four of six levels the orders are 1.12 and 1.06.
  const auto two_terms = [](double share) { return [share](double h) { return 1000.0 + h + share * h * h; }; };
  EXPECT_TRUE(convergence_of(levels_of(two_terms(0.5), 6), 2.0, 1.0).asymptotic);
  // One twice as large: at the last four of five they are 1.51 and 1.35, and 2^0.166 is 1.12.
  const Convergence bent = convergence_of(levels_of(two_terms(2.0), 5), 2.0, 1.0);
  ASSERT_TRUE(bent.order) << bent.reason;
  EXPECT_NEAR(*bent.order, 1.348, 1e-3);
  EXPECT_FALSE(bent.asymptotic);
}

/// The order of the exact solution is bracketed: what is extrapolated is within the GCI of it.
TEST(ObservedOrder, ItsIndexHoldsTheLimit) {
  for (const double share : {-0.4, -0.1, 0.1, 1.0, 3.0}) {
    const Convergence c =
        convergence_of(levels_of([share](double h) { return 7.0 + 0.1 * (h + share * h * h); }), 2.0, 1.0);
    ASSERT_TRUE(c.order) << share << ": " << c.reason;
    EXPECT_LE(std::abs(*c.extrapolated - 7.0), *c.errors.back()) << share;
  }
}

TEST(ObservedOrder, IsNotStatedWhereDifferencesChangeTheirSign) {
  expect_no_order(convergence_of(levels_with({1.0, 1.2, 1.1, 1.15, 1.125}), 2.0, 1.0), "change their sign");
  // The last three alone would have order 1.
  const Convergence c = convergence_of(levels_with({2.0, 1.0, 1.4, 1.2, 1.1}), 2.0, 1.0);
  expect_no_order(c, "change their sign");
  EXPECT_EQ(c.band, std::pair(1.1, 1.4));
  EXPECT_NEAR(*c.errors[0], 1.0, 1e-12) << "from the second level";
  EXPECT_NEAR(*c.errors[3], 0.3, 1e-12) << "the band is wider than what is left";
  EXPECT_NEAR(*c.errors[4], 0.3, 1e-12);
}

TEST(ObservedOrder, OverlooksWhatTheCoarsestOfFiveDo) {
  const Convergence c = convergence_of(levels_with({0.0, 1.8, 1.4, 1.2, 1.1}), 2.0, 1.0);
  ASSERT_TRUE(c.order) << c.reason;
  EXPECT_NEAR(*c.order, 1.0, 1e-12);
}

TEST(ObservedOrder, IsNotStatedBeyondTwiceTheFormalOne) {
  const auto cubic = [](double h) { return 1.0 + h * h * h; };
  expect_no_order(convergence_of(levels_of(cubic), 2.0, 1.0), "more than twice the formal one, 1");
  EXPECT_NEAR(convergence_of(levels_of(cubic), 2.0, 2.0).order.value_or(0.0), 3.0, 1e-9);
}

TEST(ObservedOrder, IsNotStatedWhereDifferencesGrowOrStagnate) {
  expect_no_order(convergence_of(levels_with({1.0, 1.1, 1.3, 1.7}), 2.0, 1.0), "do not shrink");
  expect_no_order(convergence_of(levels_with({1.0, 1.1, 1.2, 1.3}), 2.0, 1.0), "do not shrink");
  // The last three alone would have order 0.4.
  expect_no_order(convergence_of(levels_with({1.0, 1.01, 1.2, 1.344}), 2.0, 1.0), "do not shrink");
}

TEST(ObservedOrder, IsNotStatedAtRounding) {
  expect_no_order(convergence_of(levels_with({2.0, 2.0, 2.0}), 2.0, 1.0), "rounding");
  expect_no_order(convergence_of(levels_with({0.0, 0.0, 0.0}), 2.0, 1.0), "rounding");
  const double ulp = std::nextafter(1.0, 2.0) - 1.0;
  const Convergence c =
      convergence_of(levels_with({1.1, 1.0 + 16 * ulp, 1.0 + 4 * ulp, 1.0 + 2 * ulp, 1.0 + ulp}), 2.0, 1.0);
  expect_no_order(c, "rounding");
  EXPECT_LT(c.band->second - c.band->first, 1e-14);
  expect_no_order(convergence_of(levels_with({1.0, 2.0, 2.0, 3.0, 3.5}), 2.0, 1.0), "some of the last levels");
}

TEST(ObservedOrder, IsNotStatedWhereContactsSwitch) {
  std::vector<LevelResult> levels = levels_of([](double h) { return 1.0 + h; });
  for (LevelResult& level : levels) level.contacts = {{"landings", 1.0}, {"colliding_mean", 21.0}};
  levels[1].contacts[1].second = 22.0;
  EXPECT_TRUE(convergence_of(levels, 2.0, 1.0).order) << "the coarse levels do not count";
  levels[4].contacts[1].second = 21.5;
  const Convergence c = convergence_of(levels, 2.0, 1.0);
  expect_no_order(c, "contacts switch between the last levels (colliding_mean is 21 at");
  EXPECT_EQ(c.band, std::pair(1.0625, 1.25));
  EXPECT_NEAR(*c.errors[0], 1.0 - 0.0625, 1e-12);
}

TEST(ObservedOrder, CountsLevelsThatEndAsTheFinest) {
  std::vector<LevelResult> levels = levels_of([](double h) { return 1.0 + h; });
  levels[0] = {"h = 1", "diverges", std::nullopt};
  levels[1].outcome = "went_through";
  const Convergence c = convergence_of(levels, 2.0, 1.0);
  ASSERT_TRUE(c.order) << c.reason;
  EXPECT_NEAR(*c.extrapolated, 1.0, 1e-12);
  EXPECT_FALSE(c.errors[0] || c.errors[1] || !c.errors[2]);
  levels[2].result.reset();
  const Convergence two = convergence_of(levels, 2.0, 1.0);
  expect_no_order(two, "the run at h = 0.250000 has no value of the metric (completes), which leaves 2 levels");
  EXPECT_EQ(two.band, std::pair(1.0625, 1.125));
  levels[4].outcome = "stuck";
  expect_no_order(convergence_of(levels, 2.0, 1.0), "ends with completes, which leaves 1 levels");
  EXPECT_FALSE(convergence_of(levels, 2.0, 1.0).band);
  levels[4].result.reset();
  const Convergence none = convergence_of(levels, 2.0, 1.0);
  expect_no_order(none, "the finest run, at h = 0.062500, has no value of the metric (stuck)");
  for (const auto& error : none.errors) EXPECT_FALSE(error);
  expect_no_order(convergence_of(levels_with({1.0, 2.0}), 2.0, 1.0), "2 levels are fewer than three");
}

TEST(ObservedOrder, IsNotStatedWhereOneKnowsBefore) {
  const Convergence c =
      convergence_of(levels_of([](double h) { return 1.0 + h; }), 2.0, 1.0, "the noise is drawn anew");
  expect_no_order(c, "the noise is drawn anew");
  EXPECT_TRUE(c.band);
}

/// Of noise an order is rarely stated: of the last four levels all differences must have one sign (a twelfth of the
/// orders of four numbers), and both orders must be credible.
TEST(ObservedOrder, IsRarelyFoundInNoise) {
  int stated = 0, asymptotic = 0;
  std::uint64_t state = 1;
  const auto random = [&state] {  // Lehmer's generator
    state = state * 48271 % 2147483647;
    return static_cast<double>(state) / 2147483647.0;
  };
  constexpr int kTrials = 20'000;
  for (int i = 0; i < kTrials; ++i) {
    const Convergence c = convergence_of(levels_of([&](double) { return 1.0 + 0.01 * random(); }), 2.0, 1.0);
    stated += c.order ? 1 : 0;
    asymptotic += c.asymptotic ? 1 : 0;
  }
  EXPECT_LT(stated, kTrials / 50);
  EXPECT_LT(asymptotic, kTrials / 200);
}

}  // namespace
}  // namespace hapbench::order_test
