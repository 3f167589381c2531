#include "scenarios/analysis/stability/interval_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <span>

namespace hapbench::interval_search_test {
namespace {

using Stable = std::function<bool(double value)>;

/// Returns the last stable value in 1e4 … 1e6 that find_verified_interval finds. Returns 0 if no value is stable, and
/// -1 if stable and unstable values alternate. `current`: the scenario's value.
double tried_limit(const Stable& stable, std::optional<double> current = {}) {
  const IntervalSearchOptions options{.range = {1e4, 1e6, true}, .current = current};
  const auto holds = [&](double part) { return stable(options.value_at(part)); };
  std::map<double, bool> tried = evaluate_scan(kScanIntervals, holds);
  const StableInterval found = find_verified_interval(options, tried, holds, true, [](std::span<const double>) {});
  return found.stable ? options.value_at(*found.stable) : found.scattered ? -1.0 : 0.0;
}

TEST(TriedLimit, IsBelowAnIslandThatBisectionDoesNotMeet) {
  const Stable islands = [](double K) { return K < 3e5 && !(K > 1.05e5 && K < 1.2e5); };
  const IntervalSearchOptions options{.range = {1e4, 1e6, true}};
  const auto holds = [&](double part) { return islands(options.value_at(part)); };
  std::map<double, bool> tried = evaluate_scan(kScanIntervals, holds);
  EXPECT_NEAR(options.value_at(find_stable_interval(options, tried, holds, true).stable.value()), 3e5, 300.0);
  EXPECT_NEAR(tried_limit(islands), 1.05e5, 105.0);
}

TEST(TriedLimit, IsOfAStretchOfTwoPercent) {
  // 56 234 and 237 137 are values that the scan tests.
  EXPECT_EQ(tried_limit([](double K) { return K > 56000.0 && K < 56500.0; }), -1.0);
  EXPECT_NEAR(tried_limit([](double K) { return (K > 56000.0 && K < 56500.0) || (K > 2e5 && K < 3e5); }), 3e5, 300.0);
  EXPECT_EQ(tried_limit([](double K) { return std::fmod(std::sqrt(K) + 0.5, 1.0) < 0.5; }), -1.0) << "by chance";
  EXPECT_EQ(tried_limit([](double) { return false; }), 0.0);
}

/// Checks that a short stable interval around the scenario's value does not hide longer intervals below and above it.
TEST(TriedLimit, DoesNotDependOnACurrentValueInAShortInterval) {
  const auto is_current = [](double K) { return K > 119500.0 && K < 120500.0; };
  const Stable below = [&](double K) { return (K > 2e4 && K < 5e4) || is_current(K); };
  const Stable above = [&](double K) { return is_current(K) || (K > 2e5 && K < 3e5); };
  for (const std::optional<double>& current : {std::optional(120000.0), std::optional(5e5), std::optional<double>()}) {
    EXPECT_NEAR(tried_limit(below, current), 5e4, 50.0);
    EXPECT_NEAR(tried_limit(above, current), 3e5, 300.0);
    EXPECT_LE(tried_limit(is_current, current), 0.0);
  }
  EXPECT_EQ(tried_limit(is_current, 120000.0), -1.0);
}

TEST(TriedLimit, LeavesAShareThatMayFail) {
  EXPECT_NEAR(std::pow(1.0 - may_fail_share(48), 48.0), 0.05, 1e-12);
  EXPECT_NEAR(may_fail_share(48), 0.0605, 1e-4);
}

}  // namespace
}  // namespace hapbench::interval_search_test
