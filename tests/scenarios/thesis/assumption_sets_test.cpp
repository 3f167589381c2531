#include "scenarios/thesis/assumption_sets.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/judging.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::assumption_sets_test {
namespace {

const std::filesystem::path kReference = std::filesystem::path(HAPBENCH_SCENARIOS) / "../../results/reference";

/// Fixture with two assumptions, and two claims written for this test: one about the stiffness of the springs, and one
/// that always fails.
class AssumptionSets : public testing::Test {
 protected:
  AssumptionSets() {
    const auto assumption = [](const char* id, Json more) {
      Json json = {{"id", id}, {"what", ""}, {"thesis", ""}, {"chosen", "after"}, {"why", ""}};
      json.update(more);
      json["fields"][0]["scenarios"] = {"springs_unlimited_mean"};
      return json;
    };
    const Json path = {{"path", "rendering.stiffness_N_per_m"}, {"times", true}};
    const Json file = {
        {"assumptions",
         {assumption("stiffness", {{"value", 1}, {"range", {0.5, 2}}, {"fields", Json::array({path})}}),
          assumption("seed", {{"value", "1"}, {"options", {"1", "2"}}, {"fields", {{{"path", "seed"}}}}})}}};
    test::write_plainly(directory_ / "assumptions.json", file.dump());
  }

  Assumptions assumptions() const { return Assumptions(directory_ / "assumptions.json"); }
  std::vector<AssumptionSet> read(const std::string& text) const {
    test::write_plainly(directory_ / "sets.csv", text);
    return read_assumption_sets(directory_ / "sets.csv", assumptions());
  }
  static std::vector<Claim> claims() {
    const Claim stiff = {.id = "stiff",
                         .measure = [](const Evidence& e) -> Measured {
                           return {{"",
                                    {{"stiffness", {e.load("springs_unlimited_mean").scenario.rendering.stiffness}},
                                     {"force", {e.number("springs_unlimited_mean", "metrics.force_max_N")}}}}};
                         },
                         .judge = [](const Measured& m, const PublishedNumbers&) -> Finding {
                           EXPECT_GT(m[0]["force"], 0.0);
                           return {m[0]["stiffness"] > 20000.0 ? Verdict::replicated : Verdict::qualitatively};
                         },
                         .number = "<stiffness.mean:.0f> N/m"};
    const Claim failing = {.id = "failing",
                           .measure = [](const Evidence& e) -> Measured {
                             e.table("springs_unlimited_mean", "none.csv");
                             return {};
                           },
                           .judge = [](const Measured&, const PublishedNumbers&) -> Finding { return {}; }};
    return {stiff, failing};
  }
  test::TemporaryDirectory directory_;
};

TEST_F(AssumptionSets, KeepRecordedValuesWithoutAColumn) {
  const std::vector<AssumptionSet> sets = read("stiffness\n0.5\n2\n");
  ASSERT_EQ(sets.size(), 2u);
  EXPECT_EQ(sets[0].values, (std::vector<std::string>{"0.5", "1"}));
  EXPECT_EQ(sets[1].given, (std::set<std::size_t>{0}));
  EXPECT_EQ(difference_text(sets[1], assumptions()), "stiffness = 2");
  EXPECT_EQ(difference_text({assumptions().recorded_values()}, assumptions()), "as recorded");
}

TEST_F(AssumptionSets, JudgeEveryClaimWithTheirValues) {
  const Assumptions of_file = assumptions();
  const PublishedNumbers published;
  const std::vector<AssumptionSet> sets = read("stiffness,seed\n0.5,2\n2,1\n");
  for (const AssumptionSet& set : sets) {
    const std::vector<SetFinding> found = judge_set({of_file, published}, {set}, claims(), directory_ / "runs");
    ASSERT_EQ(found.size(), 2u);
    const bool stiff = set.values[0] == "2";
    EXPECT_EQ(found[0].verdict, stiff ? "replicated" : "qualitatively replicated");
    EXPECT_EQ(found[0].number, stiff ? "40000 N/m" : "10000 N/m");
    EXPECT_EQ(found[0].scenarios, (std::vector<std::string>{"springs_unlimited_mean"}));
    EXPECT_EQ(found[1].verdict, kNotMeasured);
    EXPECT_NE(found[1].why.find("none.csv"), std::string::npos) << found[1].why;
  }
  EXPECT_FALSE(std::filesystem::exists(directory_ / "runs")) << "results are removed";
}

TEST_F(AssumptionSets, JudgeNothingThatUsesAScenarioOfAMissedCalibration) {
  const Assumptions of_file = assumptions();
  const PublishedNumbers published;
  CalibratedSet missed{{of_file.recorded_values()}, {0}};
  Json json = Json::parse(test::read_file(directory_ / "assumptions.json"));
  json["assumptions"][0]["calibrated"] = {{"scenario", "springs_unlimited_mean"}, {"raw", 5}};
  test::write_plainly(directory_ / "calibrated.json", json.dump());
  const Assumptions with_input(directory_ / "calibrated.json");
  const std::vector<SetFinding> found = judge_set({with_input, published}, missed, claims(), directory_ / "runs");
  EXPECT_EQ(found[0].verdict, "not judged");
  EXPECT_EQ(found[0].why, "no value of stiffness gives the published 5 raw points");
}

/// Checks the calibration of the hand's force in task 2. If the assumption about the pushing direction of the hand
/// changes (task2.hand_angle), the number of contacts before the reduction changes. The calibration then finds a force
/// of the hand that restores this number. If the force is one of the assumptions that the set itself gives (`given`),
/// the calibration keeps this force.
TEST(Calibration, OfRecordedInputsIsMadeAnew) {
  const Assumptions assumptions(kReference / "assumptions.json");
  const auto index = [&](const std::string& id) {
    const auto& all = assumptions.all();
    return static_cast<std::size_t>(std::ranges::find(all, id, &Assumption::id) - all.begin());
  };
  const std::size_t hand = index("task2.hand_force");
  AssumptionSet set{assumptions.recorded_values()};
  EXPECT_EQ(calibrated(set, assumptions).set.values, set.values) << "nothing differs";
  set.values[index("task2.hand_angle")] = "0.2";
  const CalibratedSet anew = calibrated(set, assumptions);
  EXPECT_NE(anew.set.values[hand], set.values[hand]);
  EXPECT_TRUE(anew.missed.empty());
  set.given.insert(hand);
  EXPECT_EQ(calibrated(set, assumptions).set.values[hand], set.values[hand]);
}

}  // namespace
}  // namespace hapbench::assumption_sets_test
