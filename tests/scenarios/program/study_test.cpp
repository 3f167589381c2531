#include "scenarios/program/study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "scenarios/format/bundled_scenarios.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// Studies: questions as files.
namespace hapbench::study_test {
namespace {

using Words = std::vector<std::string>;

class Study : public testing::Test {
 protected:
  std::string file(const std::string& text) {
    test::write_plainly(directory_ / "mine.json", text);
    return (directory_ / "mine.json").string();
  }
  test::TemporaryDirectory directory_;
};

TEST_F(Study, IsTheWordsOfItsCommand) {
  const std::string mine = file(R"({
    "ask": "limit", "scenarios": ["a", "b.json"], "summary": "s", "between": [1e2, 1e5], "smallest": true, "resolution": 0.01,
    "algorithms": ["mean", "proxy"], "bound": ["x=1", "y=2"], "set": {"hand": {"mass_kg": 1}, "seed": 3},
    "over": {"device.delay_samples": {"from": 0, "to": 8, "count": 5, "log": true}, "integrator.type": ["rk4", "event"],
             "device": [{"type": "ideal"}]}})");
  const auto words = StudyWords::in({"limit", "--quiet", mine, "--resolution=0.5"});
  ASSERT_TRUE(words);
  EXPECT_EQ(fmt::format("{}", fmt::join(words->words, " ")),
            "limit a b.json --between 100:1e+05 --smallest --algorithms mean,proxy --bound x=1 --bound y=2 "
            R"(--set hand={"mass_kg":1} --set seed=3 --over device.delay_samples=0:8:5:log )"
            R"(--over integrator.type=rk4,event --over device={"type":"ideal"} --quiet --resolution=0.5)")
      << "an option that is given goes before the study's";
  test::write_plainly(directory_ / "b.json", "{}");
  EXPECT_EQ(StudyWords::in({"limit", mine})->words[2], (directory_ / "b.json").string()) << "beside the study";
  EXPECT_FALSE(StudyWords::in({"limit", "single_spring"}));
  EXPECT_FALSE(StudyWords::in({"describe", "stability_z_width"}));
}

TEST_F(Study, IsRefusedByAnotherCommandAndAtTheLineOfItsFault) {
  const std::string mine = file("{\n\"ask\": \"limit\",\n\"scenarios\": [\"single_spring\"],\n\"stable\": \"never\"}");
  const test::ProgramRun other = test::hapbench({"sweep", mine});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("line 2: is a question for \"hapbench limit "), std::string::npos) << other.err;
  const test::ProgramRun wrong = test::hapbench({"limit", mine, "--out", (directory_ / "out").string()});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find(mine + ":4: limit: --stable: "), std::string::npos) << wrong.err;
}

/// What makes a question of a command a matter of a second.
const std::map<std::string, Words> kShorter = {
    {"compare", {"--set", "time.steps=20", "--set", "expect={}", "--algorithms", "mean"}},
    {"limit", {"--set", "time.steps=20", "--resolution", "0.5", "--algorithms", "mean"}},
    {"run", {"--set", "time.steps=20"}},
    {"stress", {"--count", "100"}},
    {"sweep", {"--row", "0", "--print"}}};

TEST_F(Study, OfTheProgramHasANameOfItsOwnAndIsAnswered) {
  std::set<std::string> scenes;
  for (const BundledScenario& scene : bundled_scenarios()) scenes.insert(scene.name);
  ASSERT_GT(bundled_studies().size(), 5u);
  for (const BundledStudy& study : bundled_studies()) {
    EXPECT_FALSE(scenes.contains(study.name)) << study.name;
    EXPECT_FALSE(study.summary.empty()) << study.name;
    Words words = {study.ask, study.name, "--out", (directory_ / study.name).string(), "--quiet"};
    const Words& shorter = kShorter.at(study.ask);
    words.insert(words.end(), shorter.begin(), shorter.end());
    const test::ProgramRun run = test::hapbench(words);
    // How shortened runs end is not asked.
    EXPECT_TRUE(run.status == 0 || (study.ask == "run" && run.status == 3)) << study.name << ": " << run.err;
  }
}

}  // namespace
}  // namespace hapbench::study_test
