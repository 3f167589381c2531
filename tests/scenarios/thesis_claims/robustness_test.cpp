#include "scenarios/thesis_claims/robustness_run.hpp"

#include <gtest/gtest.h>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis_claims/ledger.hpp"
#include "tests/results/files.hpp"

namespace hapbench::robustness_test {
namespace {

namespace fs = std::filesystem;

/// Two choices, and claims that are made up: about the springs' stiffness, one that is costly, one that always fails.
class Robustness : public testing::Test {
 protected:
  Robustness() {
    const Json choices = {
        {"choices",
         {{{"id", "stiffness"},
           {"what", ""},
           {"thesis", ""},
           {"value", 1},
           {"range", {0.5, 2}},
           {"scale", "log"},
           {"chosen", "after"},
           {"why", ""},
           {"fields",
            {{{"scenarios", {"springs_unlimited_mean"}}, {"path", "rendering.stiffness_N_per_m"}, {"times", true}}}}},
          {{"id", "seed"},
           {"what", ""},
           {"thesis", ""},
           {"value", "1"},
           {"options", {"1", "2"}},
           {"chosen", "after"},
           {"why", ""},
           {"fields", {{{"scenarios", {"springs_unlimited_mean"}}, {"path", "seed"}}}}}}}};
    test::write_plainly(directory_ / "choices.json", choices.dump());
  }

  static const std::vector<Claim>& claims() {
    static const std::vector<Claim> claims = {
        {.id = "stiff",
         .place = "",
         .claim = "",
         .published = "",
         .rule = nullptr,
         .measure = [](const Evidence& e) -> Measured {
           return {{"",
                    {{"stiffness", {e.load("springs_unlimited_mean").scenario.rendering.stiffness}},
                     {"force", {e.results.number("springs_unlimited_mean", "metrics.force_max_N")}}}}};
         },
         .judge = [](const Measured& m, const PublishedNumbers&) -> Finding {
           EXPECT_GT(m[0]["force"], 0.0);
           return {m[0]["stiffness"] > 20000.0 ? Verdict::reproduced : Verdict::in_kind, "", ""};
         }},
        {.id = "costly",
         .place = "",
         .claim = "",
         .published = "",
         .rule = nullptr,
         .measure = [](const Evidence&) { return Measured(); },
         .judge = [](const Measured&, const PublishedNumbers&) -> Finding {
           return {Verdict::refuted, "", ""};
         },
         .costly = true},
        {.id = "failing",
         .place = "",
         .claim = "",
         .published = "",
         .rule = nullptr,
         .measure = [](const Evidence& e) -> Measured {
           e.results.table("springs_unlimited_mean", "none.csv");
           return {};
         },
         .judge = [](const Measured&, const PublishedNumbers&) -> Finding { return {}; }},
        {.id = "timing",
         .place = "",
         .claim = "",
         .published = "",
         .rule = nullptr,
         .measure = nullptr,
         .judge = nullptr,
         .timing = true}};
    return claims;
  }

  RobustnessPlan plan(std::size_t samples) const {
    return plan_robustness(Choices(directory_ / "choices.json"),
                           PublishedNumbers(HAPBENCH_SCENARIOS "/../results/reference/published"), claims(),
                           {{"springs_unlimited_mean", {"metrics"}}}, samples);
  }
  RobustnessReport run(const RobustnessPlan& plan, std::size_t jobs) const {
    return run_robustness(plan, {directory_.path(), jobs, false, false});
  }
  test::TemporaryDirectory directory_;
};

TEST_F(Robustness, JudgesEverySampleWithItsOwnChoices) {
  const RobustnessPlan p = plan(16);
  const RobustnessReport report = run(p, 2);
  ASSERT_EQ(report.verdicts.size(), 16u);
  EXPECT_EQ(report.problems.size(), 16u);
  for (std::size_t sample = 0; sample < 16; ++sample) {
    const bool stiff = *finite_number(p.values[sample][0]) > 1.0;
    EXPECT_EQ(report.verdicts[sample], (std::vector<std::string>{stiff ? "reproduced" : "reproduced in kind",
                                                                 sample < 4 ? "refuted" : "", "error"}));
  }
  EXPECT_FALSE(fs::exists(directory_ / "robustness")) << "results of samples are removed";
  const auto lines = test::lines_of(robustness_table(p, report.verdicts));
  EXPECT_EQ(lines.at(0), "sample,stiffness,seed,stiff,costly,failing");
  EXPECT_EQ(lines.size(), 17u);
}

TEST_F(Robustness, DependsNeitherOnJobsNorOnInterruptions) {
  const RobustnessPlan p = plan(8);
  const RobustnessReport whole = run(p, 1);
  const std::string journal = test::read_file(directory_ / "robustness.journal");
  // The first five samples and half a line more, as a kill may leave it.
  std::size_t end = 0;
  for (int line = 0; line < 6; ++line) end = journal.find('\n', end) + 1;
  test::write_plainly(directory_ / "robustness.journal", journal.substr(0, end + 9));
  const RobustnessReport resumed = run(p, 3);
  EXPECT_EQ(resumed.resumed, 5u);
  EXPECT_EQ(resumed.verdicts, whole.verdicts);
  EXPECT_EQ(run(p, 2).resumed, 8u) << "all is there";
  EXPECT_EQ(run(plan(4), 2).resumed, 0u) << "another plan begins anew";
}

TEST_F(Robustness, CountsAndNamesWhatDecides) {
  const RobustnessPlan p = plan(64);
  std::vector<std::vector<std::string>> verdicts;
  for (std::size_t sample = 0; sample < 64; ++sample) {
    verdicts.push_back({p.values[sample][1] == "2" ? "reproduced" : "refuted", sample < 16 ? "refuted" : "",
                        sample % 2 == 0 ? "error" : "reproduced"});
  }
  const auto claims = robustness_of(p, {"reproduced", "refuted", "reproduced"}, verdicts);
  ASSERT_EQ(claims.size(), 3u);
  EXPECT_EQ(claims[0].judged, 64u);
  EXPECT_EQ(claims[0].holds, 32u);
  EXPECT_EQ(claims[0].reproduced, 32u);
  ASSERT_TRUE(claims[0].decided_by);
  EXPECT_EQ(claims[0].decided_by->id, "seed");
  EXPECT_DOUBLE_EQ(claims[0].decided_by->index, 1.0);
  EXPECT_EQ(claims[1].judged, 16u);
  EXPECT_EQ(claims[1].holds, 16u);
  EXPECT_EQ(claims[1].reproduced, 0u);
  EXPECT_FALSE(claims[1].decided_by) << "it never changes";
  EXPECT_EQ(claims[2].judged, 32u);
  EXPECT_EQ(claims[2].not_measured, 32u);
  EXPECT_EQ(claims[2].verdicts, (std::map<std::string, std::size_t>{{"reproduced", 32}}));
}

TEST_F(Robustness, GoesIntoTheLedgerWhileItIsAboutTheSameChoicesAndVerdict) {
  const RobustnessPlan p = plan(4);
  const std::vector<std::vector<std::string>> verdicts(4, {"reproduced", "refuted", "error"});
  const Json record = robustness_json(p, robustness_of(p, {"reproduced", "refuted", "reproduced"}, verdicts));
  const JudgedClaim same{p.claims[0], {Verdict::reproduced, "", ""}}, other{p.claims[0], {Verdict::refuted, "", ""}};
  const RobustnessOnRecord on_record(record, p.choices.hash());
  EXPECT_EQ(robustness_text(on_record.of(same)), "this verdict in 4 of 4 samples");
  EXPECT_TRUE(on_record.of(other).is_null()) << "the verdict has changed since";
  EXPECT_TRUE(RobustnessOnRecord(record, "another hash").of(same).is_null());
  EXPECT_TRUE(RobustnessOnRecord(directory_ / "none.json", p.choices.hash()).of(same).is_null());
}

TEST(RobustnessText, SaysWhatDecides) {
  const auto counts = [](Json decided_by) {
    return Json{{"judged", 100}, {"holds", 91}, {"decided_by", std::move(decided_by)}};
  };
  EXPECT_EQ(robustness_text(counts({{"choice", "hand"}, {"index", 0.434}})),
            "this verdict in 91 of 100 samples; decided by hand (S = 0.43)");
  EXPECT_EQ(robustness_text(counts(nullptr)), "this verdict in 91 of 100 samples; no single choice decides");
  EXPECT_EQ(robustness_text(nullptr), "");
}

}  // namespace
}  // namespace hapbench::robustness_test
