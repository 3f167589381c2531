#include "scenarios/limits/convergence/convergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "scenarios/format/metric_sections.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/support/scale.hpp"

/// What is known of the error of a number, and which orders of numbers it leaves.
namespace hapbench::known_error_test {
namespace {

constexpr double kSame = 1e-3;
const std::vector<std::string> kNames = {"a", "b", "c", "d", "e", "f"};

/// True when the first number is less by more than both errors and rounding.
bool is_less(const NumberWithError& a, const NumberWithError& b) {
  const double difference = *b.value - *a.value;
  return difference > *a.error + *b.error && difference > kSame * std::max(std::abs(*a.value), std::abs(*b.value));
}

/// Whatever the numbers: each is less than all of the groups behind it, and every number with an error is in one place.
TEST(HeldOrder, IsTrueOfEveryPair) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1.0, 1.0), share(0.0, 1.0);
  for (std::size_t round = 0; round < test::cases(20'000); ++round) {
    std::vector<NumberWithError> numbers(1 + random() % kNames.size());
    std::set<std::size_t> known;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (share(random) < 0.9) numbers[i].value = value(random);
      if (share(random) < 0.9) numbers[i].error = share(random) * share(random);
      if (!numbers[i].value || !numbers[i].error) continue;
      known.insert(i);
    }
    const auto [groups, unplaced] = held_order(numbers, kSame);
    std::set<std::size_t> placed(unplaced.begin(), unplaced.end());
    std::size_t count = unplaced.size();
    for (std::size_t g = 0; g < groups.size(); ++g) {
      count += groups[g].size();
      placed.insert(groups[g].begin(), groups[g].end());
      for (const std::size_t a : groups[g]) {
        for (std::size_t later = g + 1; later < groups.size(); ++later)
          for (const std::size_t b : groups[later]) EXPECT_TRUE(is_less(numbers[a], numbers[b]));
      }
    }
    EXPECT_EQ(placed, known);
    EXPECT_EQ(count, known.size());
  }
}

TEST(HeldOrder, SaysWhatHoldsAndOfWhatNoErrorIsKnown) {
  const auto says = [](const std::vector<NumberWithError>& numbers) { return held_text(numbers, kNames, kSame); };
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}}), "the order holds: b < a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 1.0}}), "no order holds: b ~ a");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {2.1, 0.1}, {9.0, std::nullopt}}),
            "what holds is <: b < a ~ c; no error is known of d");
  EXPECT_EQ(says({{2.0, 0.1}, {1.0, 0.1}, {1.5, 7.0}}), "what holds is <: b < a; too uncertain for a place: c");
  EXPECT_EQ(says({{1.0, 0.0}, {1.0 + 1e-12, 0.0}}), "no order holds: a ~ b") << "rounding is no difference";
  EXPECT_EQ(says({{std::nullopt, 0.1}, {1.0, 0.1}}), "there is nothing to compare");
}

/// A flat tip of radius 0.5 mm in a plane, `z` its way, whose points are 0.4 mm apart: 5 of them lie within, 21 of
/// those that are 0.2 mm apart and 69 at 0.1 mm.
class FlatTip : public testing::Test {
 protected:
  static constexpr double kDepth = 2e-5, kOne = 1000.0 * kDepth;  // [m], [N]
  Json scene_ = {
      {"time", {{"step_s", 0.0005}, {"steps", 200}}},
      {"environment", {{"type", "plane"}, {"size_m", 0.004}, {"spacing_m", 0.0004}}},
      {"tool", {{"diameter_m", 0.001}, {"length_m", 0.01}, {"tip", "flat"}}},
      {"motion", {{"position", {{"type", "prescribed"}, {"x_m", 0}, {"y_m", 0}, {"z_m", -kDepth}}}}},
      {"rendering", {{"stiffness_N_per_m", 1000}, {"damping_N_s_per_m", 0}, {"virtual_coupling_N_per_m", 40'000}}}};

  struct Found {
    std::vector<KnownError> known;
    std::vector<NumberWithError> numbers;
    std::string says, refined;
  };
  Found found(const std::vector<std::string>& algorithms, const std::string& metric) const {
    test::write_plainly(directory_ / "scene.json", scene_.dump());
    const Comparison comparison = planned({.scenarios = {directory_ / "scene.json"}, .algorithms = algorithms});
    const std::vector<Result> reports = run_all(comparison.scenes, {});
    const FinerRuns finer(comparison, reports, {});
    Found found;
    found.refined = finer.refined(0);
    for (std::size_t i = 0; i < reports.size(); ++i) {
      found.known.push_back(finer.known_error(i, metric));
      found.numbers.push_back({number_of(reports[i].metrics, metric), found.known.back().sum()});
    }
    found.says = held_text(found.numbers, algorithms, kSame);
    return found;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(FlatTip, HasNoOrderWhereTwoStiffnessesCrossAsPointsGrowDenser) {
  // The 10/N rule is min(N, 10) springs stiff, and N springs in series with K_vc = 40 K are 40 N / (40 + N): 5 and
  // 4.44 for 5 points, 10 and 13.8 for 21, 10 and 25.3 for 69.
  const Found forces = found({"mcneely", "virtual_coupling"}, "force_max_N");
  EXPECT_EQ(forces.says, "no order holds: virtual_coupling ~ mcneely");
  EXPECT_NEAR(*forces.numbers[0].value, 5.0 * kOne, 1e-12);
  EXPECT_NEAR(*forces.known[0].spacing, 5.0 * kOne, 1e-9) << "the plain difference: no order is seen";
  EXPECT_GE(*forces.known[1].spacing, (25.3 - 4.45) * kOne);
  EXPECT_EQ(forces.known[0].step, 0.0) << "the motion is prescribed";
  EXPECT_EQ(forces.refined, "time.step_s 0.0005, 0.00025, 0.000125; environment.spacing_m 4e-04, 2e-04, 1e-04");
}

}  // namespace
}  // namespace hapbench::known_error_test
