#include <gtest/gtest.h>

#include <filesystem>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis_claims/robustness.hpp"
#include "tests/results/files.hpp"

/// The robustness of the claims that is committed.
namespace hapbench::robustness_on_record_test {
namespace {

namespace fs = std::filesystem;

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

TEST(RobustnessOnRecord, IsWhatTheProgramMakesOfAFewSamples) {
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
  for (const std::size_t sample : {std::size_t{0}, plan.costly_samples(), plan.samples() - 1}) {
    const SampleVerdicts judged = judge_sample(plan, sample, directory / "sample");
    EXPECT_EQ(robustness_row(plan, sample, judged.verdicts), rows[1 + sample])
        << "renew it with hapbench reproduce --robustness --ledger results/reference/claims.json";
  }
}

/// What a sample does to get at verdicts is what the ledger does.
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
}  // namespace hapbench::robustness_on_record_test
