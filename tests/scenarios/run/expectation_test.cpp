#include "scenarios/run/expectation.hpp"
#include "scenarios/description/metric_sections.hpp"

#include <gtest/gtest.h>

namespace hapbench::expectation_test {
namespace {

using Sentences = std::vector<std::string>;

RunSummary run_with_force(double force) {
  RunSummary run;
  run.metrics.rows = 10;
  run.metrics.force_max = force;
  return run;
}

ExpectFields force_between(std::optional<double> min, std::optional<double> max) {
  ExpectFields expect;
  expect.metrics["force_max_N"] = MetricBound{min, max};
  return expect;
}

TEST(Expectation, IsMetByAnyOfItsOutcomes) {
  RunSummary run = run_with_force(0.0);
  ExpectFields expect;
  for (const Outcome outcome : {Outcome::completes, Outcome::leaves_hole, Outcome::tool_horizontal}) {
    run.result.outcome = outcome;
    EXPECT_EQ(unmet_expectations(expect, run), Sentences{});
  }
  expect.outcomes = {Outcome::diverges};
  EXPECT_EQ(unmet_expectations(expect, run), Sentences{"outcome is \"tool_horizontal\"; expected \"diverges\""});
}

TEST(Expectation, OfNoDivergenceSaysWhatDiverged) {
  RunSummary run = run_with_force(0.0);
  run.result.outcome = Outcome::diverges;
  run.result.divergence = {17, 0.0085, "velocity", 2e6, 1e6};
  EXPECT_EQ(
      unmet_expectations({}, run),
      Sentences{"outcome is \"diverges\" (velocity reached 2e+06 at step 17, beyond 1e+06); expected \"completes\", "
                "\"leaves_hole\", \"tool_horizontal\""});
}

TEST(Expectation, IncludesItsBounds) {
  for (const auto& bounds :
       {force_between(2.0, 2.0), force_between({}, 2.0), force_between(2.0, {}), force_between({}, {})}) {
    EXPECT_EQ(unmet_expectations(bounds, run_with_force(2.0)), Sentences{});
  }
  EXPECT_EQ(unmet_expectations(force_between(2.5, {}), run_with_force(2.0)),
            Sentences{"force_max_N is 2; expected at least 2.5"});
  EXPECT_EQ(unmet_expectations(force_between({}, 1.5), run_with_force(2.0)),
            Sentences{"force_max_N is 2; expected at most 1.5"});
}

TEST(Expectation, OfAMetricWithoutValueIsNotMet) {
  ExpectFields expect;
  expect.metrics["ratio_max"] = MetricBound{{}, 2.0};
  EXPECT_EQ(unmet_expectations(expect, run_with_force(0.0)), Sentences{"ratio_max has no value; expected one"});
}

TEST(Expectation, MayBoundEveryMetricThatIsANumber) {
  for (const std::string& name : metric_names()) {
    ExpectFields expect;
    expect.metrics[name] = MetricBound{1e15, {}};
    EXPECT_EQ(unmet_expectations(expect, run_with_force(0.0)).size(), 1u) << name;
  }
  EXPECT_GE(metric_names().size(), 12u);
}

}  // namespace
}  // namespace hapbench::expectation_test
