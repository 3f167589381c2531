#include "scenarios/thesis/robustness.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::robustness_test {
namespace {

/// Two choices, and claims that are made up: about the springs' stiffness, one that is costly, one that always fails.
class Robustness : public testing::Test {
 protected:
  Robustness() {
    const auto choice = [](const char* id, Json more) {
      Json json = {{"id", id}, {"what", ""}, {"thesis", ""}, {"chosen", "after"}, {"why", ""}};
      json.update(more);
      json["fields"][0]["scenarios"] = {"springs_unlimited_mean"};
      return json;
    };
    const Json path = {{"path", "rendering.stiffness_N_per_m"}, {"times", true}};
    const Json choices = {
        {"choices",
         {choice("stiffness", {{"value", 1}, {"range", {0.5, 2}}, {"fields", Json::array({path})}}),
          choice("seed", {{"value", "1"}, {"options", {"1", "2"}}, {"fields", {{{"path", "seed"}}}}})}}};
    test::write_plainly(directory_ / "choices.json", choices.dump());
  }

  static Claim claim(const char* id, Measured (*measure)(const Evidence&),
                     Finding (*judge)(const Measured&, const PublishedNumbers&)) {
    return {.id = id, .measure = measure, .judge = judge};
  }
  static std::vector<JudgedClaim> claims() {
    const Claim stiff = claim(
        "stiff",
        [](const Evidence& e) -> Measured {
          return {{"",
                   {{"stiffness", {e.load("springs_unlimited_mean").scenario.rendering.stiffness}},
                    {"force", {e.number("springs_unlimited_mean", "metrics.force_max_N")}}}}};
        },
        [](const Measured& m, const PublishedNumbers&) -> Finding {
          EXPECT_GT(m[0]["force"], 0.0);
          return {m[0]["stiffness"] > 20000.0 ? Verdict::reproduced : Verdict::in_kind, "", ""};
        });
    Claim costly = claim(
        "costly", [](const Evidence&) { return Measured(); },
        [](const Measured&, const PublishedNumbers&) -> Finding {
          return {Verdict::refuted, "", ""};
        });
    costly.costly = true;
    const Claim failing = claim(
        "failing",
        [](const Evidence& e) -> Measured {
          e.table("springs_unlimited_mean", "none.csv");
          return {};
        },
        [](const Measured&, const PublishedNumbers&) -> Finding { return {}; });
    return {{stiff, {Verdict::reproduced, "", ""}, {}, "reach"},
            {costly, {Verdict::refuted, "", ""}, {}, "reach"},
            {failing, {Verdict::reproduced, "", ""}, {}, "reach"}};
  }

  Readings readings(std::size_t count) const {
    std::string file = "stiffness,seed\n";
    for (std::size_t i = 0; i < count; ++i)
      file += std::to_string(0.5 + 1.5 * static_cast<double>(i * 7 % count) / static_cast<double>(count)) +
              (i % 2 == 0 ? ",2\n" : ",1\n");
    test::write_plainly(directory_ / "readings.csv", file);
    const Choices choices(directory_ / "choices.json");
    return {choices, {}, claims(), read_readings(directory_ / "readings.csv", choices)};
  }
  test::TemporaryDirectory directory_;
};

TEST_F(Robustness, JudgesEveryReadingByItsOwnChoices) {
  const Readings r = readings(6);
  std::vector<ReadingVerdicts> judged;
  for (std::size_t i = 0; i < 6; ++i) {
    const bool stiff = *finite_number(r.values[i][0]) > 1.0;
    judged.push_back(judge_reading(r, i, directory_ / "runs"));
    EXPECT_EQ(judged[i].verdicts,
              (std::vector<std::string>{stiff ? "reproduced" : "reproduced in kind", i < 2 ? "refuted" : "", "error"}));
    ASSERT_EQ(judged[i].problems.size(), 1u);
    EXPECT_NE(judged[i].problems[0].find("none.csv"), std::string::npos) << judged[i].problems[0];
  }
  EXPECT_FALSE(std::filesystem::exists(directory_ / "runs")) << "results are removed";
  const auto lines = test::lines_of(robustness_table(r, judged));
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_EQ(lines[0], "sample,stiffness,seed,stiff,costly,failing");
  EXPECT_EQ(lines[1], "0,0.500000,2,reproduced in kind,refuted,error");
}

TEST_F(Robustness, CountsAndNamesWhatDecides) {
  const Readings r = readings(64);
  std::vector<ReadingVerdicts> judged;
  for (std::size_t i = 0; i < 64; ++i)
    judged.push_back({{r.values[i][1] == "2" ? "reproduced" : "refuted", i < 16 ? "refuted" : "",
                       i % 2 == 0 ? "error" : "reproduced"},
                      {}});
  const Json record = robustness_json(r, judged, Json::object());
  EXPECT_EQ(record.at("costly_samples"), 16);
  const Json& claims = record.at("claims");
  ASSERT_EQ(claims.size(), 3u);
  EXPECT_EQ(claims[0].at("verdicts"), Json({{"refuted", 32}, {"reproduced", 32}}));
  EXPECT_EQ(claims[0].at("majority"), "reproduced") << "of two as frequent, the one on record";
  EXPECT_EQ(claims[0].at("decided_by"), Json({{"choice", "seed"}, {"index", 1.0}}));
  const auto counts = [&claims](std::size_t c) {
    std::vector<int> found;
    for (const char* key : {"judged", "holds", "reproduced", "not_measured"})
      found.push_back(claims[c].at(key).get<int>());
    return found;
  };
  EXPECT_EQ(counts(0), (std::vector<int>{64, 32, 32, 0}));
  EXPECT_EQ(counts(1), (std::vector<int>{16, 16, 0, 0}));
  EXPECT_TRUE(claims[1].at("decided_by").is_null()) << "it never changes";
  EXPECT_EQ(counts(2), (std::vector<int>{32, 32, 32, 32}));
  EXPECT_EQ(claims[2].at("verdicts"), Json({{"reproduced", 32}}));
}

TEST_F(Robustness, GoesIntoTheLedgerWhileItIsAboutTheSameChoicesAndVerdict) {
  Readings r = readings(4);
  const std::vector<ReadingVerdicts> judged(4, {{"reproduced", "refuted", "error"}, {}});
  const Json record = robustness_json(r, judged, Json::object());
  const JudgedClaim& same = r.claims[0];
  JudgedClaim other = same, untouched = same, moved = same;
  other.finding.verdict = Verdict::refuted;
  moved.reach = "another";
  untouched.reach = "";
  const auto on_record = [&record](const JudgedClaim& claim) {
    return Json(ledger_json({claim}, {}, record).at("claims").at(0).at("robustness"));
  };
  EXPECT_EQ(on_record(same).at("holds"), 4);
  EXPECT_EQ(on_record(same).at("majority"), "reproduced");
  EXPECT_TRUE(on_record(other).is_null()) << "the verdict has changed since";
  EXPECT_TRUE(on_record(moved).is_null()) << "the choices that reach it have changed since";
  EXPECT_TRUE(on_record(untouched).is_null()) << "readings say nothing of it";
  EXPECT_TRUE(test::input_error_of([&] { ledger_json({same}, {}, Json::object()); }));
  // A record of other claims keeps it.
  Readings none = r;
  none.claims.clear();
  EXPECT_EQ(robustness_json(none, {}, record).at("claims"), record.at("claims"));
}

}  // namespace
}  // namespace hapbench::robustness_test
