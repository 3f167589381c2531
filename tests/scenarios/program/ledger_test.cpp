#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis_claims/robustness.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// The ledger of claims and their robustness that are committed, and the command that makes them.
namespace hapbench::ledger_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;

/// By id, without the claims whose findings hold times.
std::map<std::string, Json> repeatable_claims(const Json& ledger) {
  std::map<std::string, Json> claims;
  for (const Json& claim : ledger["claims"]) {
    if (!claim["timing"].get<bool>()) claims[claim["id"]] = claim;
  }
  return claims;
}

TEST(Ledger, InTheTreeIsTheOneTheProgramMakes) {
  const test::TemporaryDirectory directory;
  const test::ProgramRun run = hapbench({"reproduce", "--out", (directory / "out").string(), "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto made = repeatable_claims(Json::parse(test::read_file(directory / "out/claims.json")));
  const auto kept =
      repeatable_claims(Json::parse(test::read_file(HAPBENCH_SCENARIOS "/../results/reference/claims.json")));
  ASSERT_EQ(made.size(), kept.size());
  const std::vector<Claim> all = all_claims();
  const auto repeatable = std::count_if(all.begin(), all.end(), [](const Claim& claim) { return !claim.timing; });
  EXPECT_EQ(made.size(), static_cast<std::size_t>(repeatable));
  for (const auto& [id, claim] : kept) {
    ASSERT_TRUE(made.contains(id)) << id;
    EXPECT_EQ(made.at(id), claim) << id << ": renew it with hapbench reproduce --ledger results/reference/claims.json";
  }
}

TEST(Ledger, JudgesSingleClaims) {
  const test::TemporaryDirectory directory;
  const test::ProgramRun run =
      hapbench({"reproduce", "--only", "A4,B3,C4", "--out", (directory / "out").string(), "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json claims = run.json()["claims"];
  ASSERT_EQ(claims.size(), 3u);
  EXPECT_EQ(claims[1]["verdict"], "reproduced");
  EXPECT_EQ(claims[2]["verdict"], "not reproducible");
  // A4 loads one scenario, B3 lays its contacts by hand.
  EXPECT_EQ(claims[0]["scenarios"], Json::array({"single_spring"}));
  EXPECT_EQ(claims[1]["scenarios"], Json::array());
}

// It would replace the ledger of all claims.
TEST(Ledger, IsNotWrittenOfSingleClaimsUnlessItIsSaidWhere) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string(), ledger = (directory / "b3.json").string();
  std::filesystem::create_directories(out);
  test::write_plainly(directory / "out/claims.json", "mine");
  const test::ProgramRun run = hapbench({"reproduce", "--only", "b3", "--out", out});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("\nB3   two more points"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("\n     why: "), std::string::npos) << run.out;
  EXPECT_EQ(test::read_file(directory / "out/claims.json"), "mine");
  EXPECT_FALSE(std::filesystem::exists(directory / "out/claims.md"));
  ASSERT_EQ(hapbench({"reproduce", "--only", "B3", "--out", out, "--ledger", ledger}).status, 0);
  EXPECT_EQ(Json::parse(test::read_file(ledger))["claims"][0]["id"], "B3");
}

TEST(Ledger, RefusesClaimsThatAreNotThere) {
  const test::TemporaryDirectory directory;
  const test::ProgramRun run = hapbench({"reproduce", "--only", "T11", "--out", (directory / "out").string()});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("--only: got \"T11\"; allowed: \"T1\""), std::string::npos) << run.err;
  EXPECT_FALSE(std::filesystem::exists(directory / "out"));
}

const fs::path kReference = fs::path(HAPBENCH_SCENARIOS) / "../results/reference";

/// The claims of the table's columns, in their order.
std::vector<Claim> claims_of(const Words& columns, std::size_t first) {
  std::vector<Claim> claims;
  for (std::size_t i = first; i < columns.size(); ++i) {
    for (const Claim& claim : all_claims()) {
      if (claim.id == columns[i]) claims.push_back(claim);
    }
  }
  return claims;
}

TEST(RobustnessOnRecord, IsWhatTheProgramMakesOfASample) {
  if (!fs::exists(kReference / "robustness.csv")) GTEST_SKIP() << "there is none";
  const Choices choices(kReference / "choices.json");
  const Json record = Json::parse(test::read_file(kReference / "robustness.json"));
  if (record.at("choices") != choices.hash()) GTEST_SKIP() << "it is about other choices";
  const auto rows = test::lines_of(test::read_file(kReference / "robustness.csv"));
  const std::vector<Claim> claims = claims_of(parts_of(rows.at(0), ','), 1 + choices.all().size());
  const RobustnessPlan plan =
      plan_robustness(choices, PublishedNumbers(kReference / "published"), claims, {}, rows.size() - 1);
  ASSERT_EQ(robustness_table(plan, std::vector<std::vector<std::string>>(plan.samples())).find(rows[0] + "\n"), 0u);
  const test::TemporaryDirectory directory;
  const std::size_t sample = plan.samples() - 1;  // one takes a minute of a core
  const SampleVerdicts judged = judge_sample(plan, sample, directory / "sample");
  EXPECT_EQ(robustness_row(plan, sample, judged.verdicts), rows[1 + sample])
      << "renew it with hapbench reproduce --robustness --ledger results/reference/claims.json";
}

/// A sample gets its verdicts as the ledger does.
TEST(RobustnessOnRecord, OfTheChoicesOnRecordIsTheLedger) {
  const Json ledger = Json::parse(test::read_file(kReference / "claims.json")).at("claims");
  std::vector<Claim> claims;
  std::vector<std::string> verdicts;
  for (const Json& entry : ledger) {
    for (const Claim& claim : all_claims()) {
      if (claim.id != entry.at("id") || claim.timing || claim.costly) continue;
      claims.push_back(claim);
      verdicts.push_back(entry.at("verdict"));
    }
  }
  RobustnessPlan plan =
      plan_robustness(Choices(kReference / "choices.json"), PublishedNumbers(kReference / "published"), claims, {}, 1);
  plan.values = {plan.choices.values_on_record()};
  const test::TemporaryDirectory directory;
  const SampleVerdicts judged = judge_sample(plan, 0, directory / "sample");
  EXPECT_EQ(judged.verdicts, verdicts);
  EXPECT_TRUE(judged.problems.empty());
}

}  // namespace
}  // namespace hapbench::ledger_test
