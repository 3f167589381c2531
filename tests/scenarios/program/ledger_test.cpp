#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// The claims ledger that is committed, and the command that makes it.
namespace hapbench::ledger_test {
namespace {

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
  EXPECT_GE(made.size(), 25u);
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

}  // namespace
}  // namespace hapbench::ledger_test
