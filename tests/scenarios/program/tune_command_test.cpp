#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench tune: what it prints, writes and refuses.
namespace hapbench::tune_command_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using test::hapbench;
using test::lines_of;
using test::read_file;

class TuneCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  Words words(const Words& more, const std::string& out = "out") const {
    Words words = {"tune", "tap_wall", "--out", file(out)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(TuneCommand, ItsScenarioGivesTheMetricsThatWerePrinted) {
  // Another device over the scene's, and one of its fields: sections that extending alone would mix.
  const Json json = hapbench(words({"--device", "touch", "--set", "device.delay_samples=0.5", "--max-inside", "10",
                                    "--algorithms", "shaped_stiffness,mean", "--json"}))
                        .json();
  ASSERT_EQ(json["algorithms"].size(), 2u);
  ASSERT_TRUE(json["recommended"].is_string()) << json.dump(1);
  const Json* best = nullptr;
  for (const Json& law : json["algorithms"])
    if (law["algorithm"] == json["recommended"]) best = &law;
  ASSERT_NE(best, nullptr);
  EXPECT_TRUE((*best)["feasible"].get<bool>());
  EXPECT_GE((*best)["margins"]["gain"].get<double>(), 2.0);
  EXPECT_EQ(json["limits"]["inside_max_m"]["max"], 0.01);
  const std::string tuned = file("out/tap_wall_tuned.json");
  EXPECT_EQ(json["scenario"], tuned);
  const Json run = hapbench({"run", tuned, "--json", "--out", file("run")}).json();
  EXPECT_EQ(run[0]["algorithm"], json["recommended"]);
  for (const auto& [name, value] : (*best)["metrics"].items()) EXPECT_EQ(run[0]["metrics"][name], value) << name;
  const Json effective = Json::parse(read_file(file("run/scenario.effective.json")));
  EXPECT_EQ(effective["rendering"]["stiffness_N_per_m"], (*best)["stiffness_N_per_m"]);
  EXPECT_EQ(effective["device"]["delay_samples"], 0.5);
  std::size_t runs = 0;
  for (const Json& law : json["algorithms"]) runs += law["runs"].get<std::size_t>();
  EXPECT_EQ(json["runs"], runs);
  EXPECT_EQ(lines_of(read_file(file("out/tune.csv"))).size(), 3u);
  EXPECT_GT(lines_of(read_file(file("out/tune_trials.csv"))).size(), 30u);
}

TEST_F(TuneCommand, WritesTheSameBytesHoweverManyJobs) {
  hapbench(words({"--jobs", "1", "--quiet"}, "a"));
  hapbench(words({"--jobs", "3", "--quiet"}, "b"));
  for (const char* name : {"tune.csv", "tune_trials.csv", "tap_wall_tuned.json"})
    EXPECT_EQ(read_file(directory_ / "a" / name), read_file(directory_ / "b" / name)) << name;
}

TEST_F(TuneCommand, SaysWhatToRelaxAndWritesNoScenario) {
  const Json json = hapbench(words({"--max-inside", "1e-6", "--json"})).json();
  EXPECT_TRUE(json["recommended"].is_null() && json["scenario"].is_null());
  const Json& law = json["algorithms"][0];
  EXPECT_FALSE(law["feasible"].get<bool>());
  EXPECT_EQ(law["binding"], "inside_max_m");
  EXPECT_NE(law["relax"].get<std::string>().find("in place of 1e-09"), std::string::npos) << law["relax"];
  EXPECT_FALSE(fs::exists(file("out/tap_wall_tuned.json")));
}

}  // namespace
}  // namespace hapbench::tune_command_test
