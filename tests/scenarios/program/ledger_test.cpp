#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "scenarios/thesis/robustness.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// The ledger of claims and their robustness that are committed, and the command that makes them.
namespace hapbench::ledger_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;

const fs::path kReference = fs::path(HAPBENCH_SCENARIOS) / "../../results/reference";

/// By id, without the claims whose findings hold times, and without the time that each took.
std::map<std::string, Json> repeatable_claims(const Json& ledger) {
  std::map<std::string, Json> claims;
  for (Json claim : ledger["claims"]) {
    claim.erase("seconds");
    if (!claim["timing"].get<bool>()) claims[claim["id"]] = claim;
  }
  return claims;
}

TEST(Ledger, IsReadInAMinute) {
  std::size_t rows = 0;
  for (const std::string& line : test::lines_of(test::read_file(kReference / "claims.md"))) {
    if (!line.starts_with("| ")) continue;
    ++rows;
    EXPECT_LE(std::ranges::count_if(line, [](char c) { return (c & 0xC0) != 0x80; }), 300) << line;
  }
  EXPECT_GE(rows, 2u + 6u + all_claims().size() - 3u) << "the main results, and what can be judged";
}

/// Compares what the program says of these claims with the ledger in the tree.
void expect_on_record(const Json& ledger, const std::vector<Claim>& claims) {
  const auto made = repeatable_claims(ledger),
             kept = repeatable_claims(Json::parse(test::read_file(kReference / "claims.json")));
  for (const Claim& claim : claims) {
    if (claim.timing) continue;
    ASSERT_TRUE(made.contains(claim.id) && kept.contains(claim.id)) << claim.id;
    EXPECT_EQ(made.at(claim.id), kept.at(claim.id))
        << claim.id << ": renew it with hapbench reproduce --ledger results/reference/claims.json";
  }
}

// The subjects of appendix D take four fifths of the time of all claims; their trajectories are on record in
// numbers.txt.
TEST(Ledger, OfClaimsWithoutSubjectsIsTheOneTheProgramMakes) {
  std::vector<Claim> claims = all_claims();
  std::erase_if(claims, [](const Claim& claim) { return claim.timing || claim.costly; });
  std::string ids;
  for (const Claim& claim : claims) append_item(ids, claim.id, ",");
  const test::TemporaryDirectory directory;
  const std::string ledger = (directory / "claims.json").string();
  const test::ProgramRun run =
      hapbench({"reproduce", "--only", ids, "--out", (directory / "out").string(), "--ledger", ledger, "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  expect_on_record(Json::parse(test::read_file(ledger)), claims);
}

TEST(WholeLedger, InTheTreeIsTheOneTheProgramMakes) {
  const test::TemporaryDirectory directory;
  const test::ProgramRun run = hapbench({"reproduce", "--out", (directory / "out").string(), "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json ledger = Json::parse(test::read_file(directory / "out/claims.json")),
             on_record = Json::parse(test::read_file(kReference / "claims.json"));
  EXPECT_EQ(ledger["headline"], on_record["headline"]);
  EXPECT_EQ(ledger["claims"].size(), on_record["claims"].size());
  expect_on_record(ledger, all_claims());
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

using Verdicts = std::map<std::string, std::string>;

/// The ledger's verdicts by claim, without those on claims about times and those that take long to judge.
Verdicts verdicts_on_record() {
  Verdicts verdicts;
  const Json ledger = Json::parse(test::read_file(kReference / "claims.json"));
  for (const Json& entry : ledger.at("claims")) verdicts[entry.at("id")] = entry.at("verdict");
  for (const Claim& claim : all_claims())
    if (claim.timing || claim.costly) verdicts.erase(claim.id);
  return verdicts;
}

/// The verdicts on these claims under a reading: the last one of a file, or that on record.
Verdicts verdicts_under(const std::optional<fs::path>& file) {
  const Choices choices(kReference / "choices.json");
  Readings readings{choices, PublishedNumbers(kReference / "published.json"), {}, {choices.values_on_record()}};
  if (file) readings.values = read_readings(*file, choices);
  for (const Claim& claim : all_claims())
    if (!claim.timing && !claim.costly) readings.claims.push_back({claim, {}});
  const test::TemporaryDirectory directory;
  const ReadingVerdicts judged = judge_reading(readings, readings.values.size() - 1, directory / "reading");
  EXPECT_EQ(judged.problems, std::vector<std::string>());
  Verdicts verdicts;
  for (std::size_t i = 0; i < readings.claims.size(); ++i) verdicts[readings.claims[i].claim.id] = judged.verdicts[i];
  return verdicts;
}

// Takes a minute of a core.
TEST(RobustnessOnRecord, HasTheVerdictsThatTheProgramMakesOfAReading) {
  const Verdicts made = verdicts_under(kReference / "readings.csv");
  const Json ledger = Json::parse(test::read_file(kReference / "claims.json"));
  std::size_t sampled = 0;
  for (const Json& entry : ledger.at("claims")) {
    const std::string id = entry.at("id");
    if (entry.at("robustness").is_null() || !made.contains(id)) continue;
    ++sampled;
    EXPECT_TRUE(entry.at("robustness").at("verdicts").contains(made.at(id))) << id << ": " << made.at(id);
  }
  EXPECT_GT(sampled, 10u);
}

/// A reading gets its verdicts as the ledger does.
TEST(RobustnessOnRecord, OfTheChoicesOnRecordIsTheLedger) {
  EXPECT_EQ(verdicts_under(std::nullopt), verdicts_on_record());
}

}  // namespace
}  // namespace hapbench::ledger_test
