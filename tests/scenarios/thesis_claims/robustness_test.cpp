#include "scenarios/thesis_claims/robustness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis_claims/ledger.hpp"
#include "sim/core/random.hpp"
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
         .rule = "",
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
         .rule = "",
         .measure = [](const Evidence&) { return Measured(); },
         .judge = [](const Measured&, const PublishedNumbers&) -> Finding {
           return {Verdict::refuted, "", ""};
         },
         .costly = true},
        {.id = "failing",
         .place = "",
         .claim = "",
         .published = "",
         .rule = "",
         .measure = [](const Evidence& e) -> Measured {
           e.results.table("springs_unlimited_mean", "none.csv");
           return {};
         },
         .judge = [](const Measured&, const PublishedNumbers&) -> Finding { return {}; }},
        {.id = "timing",
         .place = "",
         .claim = "",
         .published = "",
         .rule = "",
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
    return run_robustness(plan, {.directory = directory_.path(), .jobs = jobs, .program = "a commit"});
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
  const std::string table = test::read_file(directory_ / "robustness_samples.csv");
  // The first five samples and half a line more, as a kill may leave it.
  std::size_t end = 0;
  for (int line = 0; line < 6; ++line) end = table.find('\n', end) + 1;
  test::write_plainly(directory_ / "robustness_samples.csv.part", table.substr(0, end + 9));
  fs::rename(directory_ / "robustness_samples.json", directory_ / "robustness_samples.json.part");
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
  const JudgedClaim same{p.claims[0], {Verdict::reproduced, "", ""}, {}, "reach"};
  JudgedClaim other = same, untouched = same, moved = same;
  other.finding.verdict = Verdict::refuted;
  moved.reach = "another";
  untouched.reach = "";
  const Json record = robustness_json(p, std::vector<JudgedClaim>(3, same),
                                      robustness_of(p, {"reproduced", "refuted", "reproduced"}, verdicts));
  const RobustnessOnRecord on_record(record);
  EXPECT_EQ(on_record.of(same).at("holds"), 4);
  EXPECT_EQ(on_record.of(same).at("majority"), "reproduced");
  EXPECT_TRUE(on_record.of(other).is_null()) << "the verdict has changed since";
  EXPECT_TRUE(on_record.of(moved).is_null()) << "the choices that reach it have changed since";
  EXPECT_TRUE(on_record.of(untouched).is_null()) << "samples say nothing of it";
  EXPECT_TRUE(RobustnessOnRecord(directory_ / "none.json").of(same).is_null());
  // A record of other claims keeps it.
  EXPECT_EQ(RobustnessOnRecord(robustness_json(p, {}, {}, record)).of(same), on_record.of(same));
}

/// A claim as the ledger has it, with counts unless they are null.
Json entry(const char* id, const char* verdict, Json counts, bool reached = true) {
  Json claim = {{"id", id},
                {"verdict", verdict},
                {"majority", counts.is_null() ? Json() : counts.at("majority")},
                {"robustness", std::move(counts)},
                {"choices_reach_it", reached},
                {"timing", false},
                {"ours", false}};
  claim["sureness"] = robustness_text(claim);
  return claim;
}

Json counts(int holds, Json decided_by, const char* majority = "reproduced") {
  return {{"judged", 100},
          {"holds", holds},
          {"majority", majority},
          {"verdicts", {{"reproduced", holds}, {"refuted", 100 - holds}}},
          {"decided_by", std::move(decided_by)}};
}

TEST(Sureness, SaysWhatDecidesAndWhatMostSamplesHave) {
  const auto text = [](Json counts, bool reached = true) {
    return robustness_text(entry("A", "reproduced", std::move(counts), reached));
  };
  EXPECT_EQ(text(counts(91, {{"choice", "hand"}, {"index", 0.434}})),
            "this verdict in 91 of 100 samples; decided by hand (S = 0.43)");
  EXPECT_EQ(text(counts(91, nullptr)), "this verdict in 91 of 100 samples; no single choice decides");
  EXPECT_EQ(text(counts(9, nullptr, "refuted")),
            "refuted in 91 of 100 samples, the recorded verdict in 9; no single choice decides");
  EXPECT_EQ(text(nullptr), "not sampled yet");
  EXPECT_EQ(text(nullptr, false), "depends on no recorded choice");
  EXPECT_EQ(verdicts_text(entry("A", "reproduced", counts(9, nullptr, "refuted"))),
            "most samples: refuted; recorded: reproduced");
  EXPECT_EQ(verdicts_text(entry("A", "reproduced", counts(91, nullptr))), "reproduced");
}

TEST(LedgerHeadline, CountsVerdictsThatAnotherReadingLeaves) {
  Json ours = entry("X", "holds", nullptr);
  ours["ours"] = true;
  const Json claims = {entry("A", "reproduced", counts(91, nullptr)),
                       entry("B", "reproduced", counts(9, nullptr, "refuted")),
                       entry("C", "reproduced", nullptr, false), entry("D", "reproduced", nullptr), ours};
  EXPECT_EQ(
      ledger_headline(claims),
      "Of 4 verdicts on claims of the thesis, 1 of the 2 sampled would survive another reasonable reading: most samples of the choices "
      "on record have them, too. 1 would not: B (most samples: refuted; recorded: reproduced). 1 "
      "depend on no recorded choice; 0 are about times or cannot be simulated; 1 have not been sampled yet.");
}

using Bins = std::vector<std::size_t>;
using Values = std::vector<double>;

Values uniform(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Values values(count);
  for (double& value : values) value = random.uniform();
  return values;
}

TEST(EqualCountBins, CutTheValuesInOrder) {
  EXPECT_EQ(equal_count_bins(Values{3, 1, 2, 4}, 2), (Bins{1, 0, 0, 1}));
  EXPECT_EQ(equal_count_bins(Values{5, 5, 5}, 3), (Bins{0, 1, 2}));
  EXPECT_TRUE(equal_count_bins(Values{}, 3).empty());
}

TEST(FirstOrderIndex, IsTheFormulasByHand) {
  // Means 0.25 and 1 about 0.625: SST = 1.875, SSB = 2 * 4 * 0.375^2 = 1.125, SSW = 0.75 with 8 - 2 degrees of freedom.
  const Bins bin = {0, 0, 0, 0, 1, 1, 1, 1};
  const Values y = {0, 0, 0, 1, 1, 1, 1, 1};
  EXPECT_NEAR(first_order_index(bin, y), (1.125 - 0.75 / 6.0) / 1.875, 1e-15);
  EXPECT_EQ(first_order_index(bin, Values{0, 0, 0, 0, 1, 1, 1, 1}), 1.0);
  EXPECT_TRUE(std::isnan(first_order_index(bin, Values(8, 1.0)))) << "nothing changes";
  EXPECT_TRUE(std::isnan(first_order_index(Bins{0, 1}, Values{0, 1}))) << "every bin has one point";
}

TEST(FirstOrderIndex, IsUnbiasedWithoutInfluenceAndThatOfAModelWithOne) {
  // y = [x1 < 1/2] or [x2 < 1/2]: Var(E[y | x1]) / Var(y) = (1/16) / (3/16) = 1/3.
  double without = 0.0, with = 0.0;
  constexpr int kRepeats = 400;
  constexpr std::size_t kPoints = 128;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto seed = static_cast<std::uint64_t>(repeat);
    const Values a = uniform(kPoints, 3 * seed), b = uniform(kPoints, 3 * seed + 1), c = uniform(kPoints, 3 * seed + 2);
    Values y(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) y[i] = a[i] < 0.5 || b[i] < 0.5 ? 1.0 : 0.0;
    // Bins with an edge where y changes; of equal count, the bin across it would blur the step.
    Bins eighths(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) eighths[i] = static_cast<std::size_t>(8.0 * a[i]);
    with += first_order_index(eighths, y) / kRepeats;
    without += first_order_index(equal_count_bins(c, 8), y) / kRepeats;
  }
  // One estimate scatters by about sqrt(2 (B - 1)) / n = 0.03 without and 0.07 with influence; four standard errors of
  // the mean of 400.
  EXPECT_NEAR(without, 0.0, 4 * 0.03 / 20);
  EXPECT_NEAR(with, 1.0 / 3.0, 4 * 0.07 / 20);
}

TEST(DecidingInput, IsTheOneThatDecidesOrNone) {
  constexpr std::size_t kPoints = 96;
  std::vector<Bins> bins;
  std::vector<Values> inputs;
  for (std::uint64_t i = 0; i < 10; ++i) {
    inputs.push_back(uniform(kPoints, 100 + i));
    bins.push_back(equal_count_bins(inputs.back(), 6));
  }
  Values y(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) y[i] = inputs[7][i] < 0.3 ? 1.0 : 0.0;
  const auto deciding = deciding_input(bins, y, 1);
  ASSERT_TRUE(deciding);
  EXPECT_EQ(deciding->input, 7u);
  EXPECT_GT(deciding->index, 0.8);
  EXPECT_FALSE(deciding_input(bins, Values(kPoints, 1.0), 1)) << "y never changes";
}

TEST(DecidingInput, RaisesFalseAlarmsAtItsLevelOnly) {
  constexpr std::size_t kPoints = 64, kTrials = 300;
  std::vector<Bins> bins;
  for (std::uint64_t i = 0; i < 10; ++i) bins.push_back(equal_count_bins(uniform(kPoints, 500 + i), 4));
  std::size_t alarms = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Values y = uniform(kPoints, 9000 + trial);
    for (double& value : y) value = value < 0.4 ? 1.0 : 0.0;
    if (deciding_input(bins, y, trial, 0.05, 99)) ++alarms;
  }
  // Binomial with p = 0.05: 15 of 300 on average, standard deviation 3.8.
  EXPECT_LE(alarms, 15u + 4 * 4);
  EXPECT_GE(alarms, 1u) << "the level is not that of something else";
}

}  // namespace
}  // namespace hapbench::robustness_test
