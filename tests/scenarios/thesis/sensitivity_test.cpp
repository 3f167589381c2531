#include "scenarios/thesis/sensitivity.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenarios/thesis/assumptions.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::sensitivity_test {
namespace {

SetFinding found(Verdict verdict, const std::string& number = "1") {
  return {std::string(verdict_name(verdict)), number, "", {}};
}

JudgedClaim judged(const std::string& id, const std::string& reach) {
  JudgedClaim claim;
  claim.claim.id = id;
  claim.claim.location = "3.3";
  claim.finding.verdict = Verdict::replicated;
  claim.reach = reach;
  return claim;
}

class Sensitivity : public testing::Test {
 protected:
  /// Returns a record of the claim T9 with the cases (assumption, verdict). Every case has the value "2".
  SensitivityRecord record(const std::vector<std::pair<std::string, Verdict>>& cases) const {
    SensitivityRecord made;
    made.begin("T9", "reach", found(Verdict::replicated), complete_ > 0 ? complete_ : cases.size());
    for (const auto& [assumption, verdict] : cases) made.add("T9", assumption, "2", found(verdict));
    return made;
  }
  std::string robustness(const std::vector<std::pair<std::string, Verdict>>& cases) const {
    const JudgedClaim claim = judged("T9", "reach");
    return robustness_of(claim, record(cases).entry("T9", "reach")).text();
  }
  std::size_t complete_ = 0;  ///< number of cases of a complete entry; 0: the number of cases that are given
  test::TemporaryDirectory directory_;
};

TEST_F(Sensitivity, NamesTheAssumptionsThatChangeTheVerdict) {
  using enum Verdict;
  EXPECT_EQ(robustness({}), "robust");
  EXPECT_EQ(robustness({{"a", replicated}, {"b", not_judged}}), "robust") << "what is not judged changes nothing";
  EXPECT_EQ(robustness({{"a", replicated}, {"b", qualitatively}, {"b", not_replicated}}), "sensitive to b");
  EXPECT_EQ(robustness({{"a", qualitatively}, {"b", qualitatively}}), "depends on several: a, b");
}

TEST_F(Sensitivity, WithoutAllCasesIsNotSampledUnlessSeveralAssumptionsChangeTheVerdict) {
  using enum Verdict;
  complete_ = 5;
  EXPECT_EQ(robustness({{"a", replicated}}), "not sampled");
  EXPECT_EQ(robustness({{"a", qualitatively}}), "not sampled");
  EXPECT_EQ(robustness({{"a", qualitatively}, {"b", qualitatively}}), "depends on several: a, b");
}

TEST_F(Sensitivity, OfAClaimWithoutAssumptionsIsExactAndWithoutARecordNotSampled) {
  JudgedClaim claim = judged("T9", "");
  EXPECT_EQ(robustness_of(claim, {}).text(), "exact");
  claim.reach = "reach";
  EXPECT_EQ(robustness_of(claim, {}).text(), "not sampled");
  const Json entry = record({{"a", Verdict::qualitatively}}).entry("T9", "reach");
  claim.claim.timing = true;
  EXPECT_EQ(robustness_of(claim, entry).text(), "not sampled") << "times depend on the machine";
}

TEST_F(Sensitivity, IsKeptInAFileAndContinued) {
  const SensitivityRecord made = record({{"a", Verdict::qualitatively}});
  test::write_plainly(directory_ / "record.json", made.text());
  SensitivityRecord read(directory_ / "record.json");
  EXPECT_EQ(read.text(), made.text());
  read.begin("T9", "reach", found(Verdict::replicated), 1);
  EXPECT_TRUE(read.has("T9", "a", "2"));
  EXPECT_FALSE(read.has("T9", "a", "3"));
  EXPECT_TRUE(read.entry("T9", "other assumptions").is_null());
  // With a changed verdict, number or list of assumptions, the cases must be computed again.
  for (const auto& [reach, recorded] : {std::pair("reach", found(Verdict::qualitatively)),
                                        {"reach", found(Verdict::replicated, "2")},
                                        {"other assumptions", found(Verdict::replicated)}}) {
    SensitivityRecord changed(directory_ / "record.json");
    changed.begin("T9", reach, recorded, 1);
    EXPECT_FALSE(changed.has("T9", "a", "2")) << reach;
  }
  SensitivityRecord empty = made;
  empty.keep_only({});
  EXPECT_TRUE(empty.entry("T9", "reach").is_null());
  EXPECT_TRUE(SensitivityRecord(directory_ / "none.json").entry("T9", "reach").is_null());
  test::write_plainly(directory_ / "record.json", R"({"claims": [{"id": "T9"}]})");
  EXPECT_TRUE(test::input_error_of([&] { SensitivityRecord broken(directory_ / "record.json"); }));
}

TEST_F(Sensitivity, CasesAreThoseThatCanChangeAClaimAndThatTheRecordLacks) {
  const Json file = {{"assumptions",
                      {{{"id", "rule.a"}, {"value", 1}, {"range", {0, 2}}},
                       {{"id", "b"},
                        {"value", "x"},
                        {"options", {"x", "y"}},
                        {"fields", {{{"scenarios", {"task2_*"}}, {"path", "seed"}}}}},
                       {{"id", "hand"},
                        {"value", 1},
                        {"range", {0.5, 2}},
                        {"calibrated", {{"scenario", "task2_x"}, {"raw", 9}}},
                        {"fields", {{{"scenarios", {"task2_*"}}, {"path", "seed"}}}}}}}};
  test::write_plainly(directory_ / "assumptions.json", file.dump());
  const Assumptions assumptions(directory_ / "assumptions.json");
  const auto judge = [](const Measured&, const PublishedNumbers&) { return Finding(); };
  std::vector<Claim> claims = {{.id = "costly", .judge = judge, .costly = true},
                               {.id = "rule", .rule = "at least <rule.a>", .judge = judge},
                               {.id = "time", .judge = judge, .timing = true}};
  SensitivityRecord record;
  for (const Claim& claim : claims) record.begin(claim.id, "reach", found(Verdict::replicated), 1);
  record.add("rule", "rule.a", "0", found(Verdict::replicated));
  std::string text;
  for (const SensitivityCase& one : missing_cases(record, assumptions, claims, {{"task2_x"}, {}, {"task2_x"}}))
    for (const Claim& claim : one.claims)
      text += assumptions.all()[one.assumption].id + " " + one.value + " " + claim.id + "; ";
  EXPECT_EQ(text, "rule.a 2 rule; b y costly; ") << "inputs have no cases, and cheap claims come first";
  // The order in which cases were judged does not matter.
  for (const char* value : {"y", "2", "0"})
    record.add("time", std::string(value) == "y" ? "b" : "rule.a", value, found(Verdict::replicated));
  record.sort_cases(assumptions);
  std::string order;
  const Json sorted = record.entry("time", "reach");
  for (const Json& one : sorted.at("cases")) order += one.at("value").get<std::string>();
  EXPECT_EQ(order, "02y");
}

TEST_F(Sensitivity, CoversTheEarlierRuleOfAClaim) {
  using enum Verdict;
  const auto both = [](Verdict now, Verdict before) {
    SetFinding finding = found(now);
    finding.earlier = verdict_name(before);
    return finding;
  };
  SensitivityRecord made;
  made.begin("T9", "reach", both(replicated, contradicted), 3);
  made.add("T9", "a", "2", both(qualitatively, contradicted));
  made.add("T9", "b", "2", both(not_judged, not_replicated));
  made.add("T9", "c", "2", both(replicated, not_judged));
  JudgedClaim claim = judged("T9", "reach");
  claim.finding.earlier = contradicted;
  claim.claim.earlier.reason = "it was wrong";
  const Json entry = made.entry("T9", "reach");
  EXPECT_EQ(robustness_of(claim, entry).text(), "sensitive to a");
  EXPECT_EQ(earlier_robustness_of(claim, entry).text(), "sensitive to b");
  const Json ledger = ledger_json({claim}, {}, made).at("claims").at(0);
  EXPECT_EQ(ledger.at("revised").at("robustness"), "sensitive to b");
  EXPECT_EQ(ledger.at("revised").at("verdict"), "contradicted");
  EXPECT_EQ(ledger.at("cases_moved").size(), 2u) << "cases whose verdict by the present rule differs";
  // A file keeps both verdicts. With another verdict of the earlier rule, the cases must be computed again.
  test::write_plainly(directory_ / "record.json", made.text());
  SensitivityRecord read(directory_ / "record.json");
  EXPECT_EQ(read.text(), made.text());
  read.begin("T9", "reach", both(replicated, contradicted), 3);
  EXPECT_TRUE(read.has("T9", "a", "2"));
  read.begin("T9", "reach", both(replicated, not_replicated), 3);
  EXPECT_FALSE(read.has("T9", "a", "2"));
  // A record that was made without earlier rules covers the present rule only.
  const Json old = record({{"a", qualitatively}}).entry("T9", "reach");
  EXPECT_EQ(robustness_of(claim, old).text(), "sensitive to a");
  EXPECT_EQ(earlier_robustness_of(claim, old).text(), "not sampled");
}

TEST_F(Sensitivity, GoesIntoTheLedgerWhileItIsAboutTheSameAssumptions) {
  const SensitivityRecord made = record({{"a", Verdict::qualitatively}, {"b", Verdict::replicated}});
  const auto ledger = [&](const JudgedClaim& claim) { return ledger_json({claim}, {}, made).at("claims").at(0); };
  const Json same = ledger(judged("T9", "reach"));
  EXPECT_EQ(same.at("robustness"), "sensitive to a");
  EXPECT_EQ(same.at("cases_tried"), 2);
  EXPECT_EQ(same.at("cases_moved").size(), 1u);
  EXPECT_EQ(ledger(judged("T9", "other")).at("robustness"), "not sampled");
}

}  // namespace
}  // namespace hapbench::sensitivity_test
