#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench tune: what it finds and writes. What it says where nothing is feasible is in tests/data/golden/studies.txt.
namespace hapbench::tune_command_test {
namespace {

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
  const Json json = hapbench(words({"--device", "touch", "--set", "device.delay_samples=0.5", "--bound",
                                    "inside_max_m=0.01", "--algorithms", "shaped_stiffness,mean", "--json"}))
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

/// Recommended, linear edge and edge in runs: for one scene and device the same from tune, limit and the device table.
TEST_F(TuneCommand, SaysTheEdgesThatLimitSays) {
  const Json law = hapbench(words({"--device", "touch", "--json"})).json()["algorithms"][0];
  ASSERT_TRUE(law["edge_in_runs"].is_number() && law["linear_edge"].is_number()) << law.dump(1);
  const std::string tuned = file("out/tap_wall_tuned.json");
  const auto asked = [&](Words words) {
    words.insert(words.begin(), {"limit", tuned, "--json", "--out", file("limit")});
    return hapbench(words).json()["limits"][0];
  };
  const Json limit = asked({}), in_table = asked({"--device", "touch", "--friction", "none"});
  EXPECT_EQ(limit["limit"], law["edge_in_runs"]);
  EXPECT_EQ(limit["linear"], law["linear_edge"]);
  EXPECT_EQ(in_table["low"], limit["low"]);
  EXPECT_NEAR(in_table["linear"].get<double>(), limit["linear"].get<double>(), 0.01 * limit["linear"].get<double>());
  EXPECT_GE(in_table["limit"], limit["limit"]) << "a table tries nothing between";
  EXPECT_GE(law["edge_in_runs"].get<double>(), 2.0 * law["stiffness_N_per_m"].get<double>());
  EXPECT_GE(law["linear_edge"].get<double>(), 2.0 * law["stiffness_N_per_m"].get<double>());
}

/// Without limits the recommendation keeps what the diagnosis calls quiet.
TEST_F(TuneCommand, RecommendsAQuietRun) {
  hapbench(words({"--quiet"}));
  const Json run = hapbench({"run", file("out/tap_wall_tuned.json"), "--json", "--out", file("run")}).json();
  for (const Json& finding : run[0]["diagnosis"])
    for (const char* rule : {"buzz", "pop", "chatter", "energy"}) EXPECT_NE(finding["rule"], rule) << finding;
}

/// A limit is kept by as much as half the step, half the spacing and a look at every row move the metric.
TEST_F(TuneCommand, KeepsALimitByTheErrorOfItsMetric) {
  const Json law = hapbench(words({"--bound", "inside_max_m=5e-4", "--json"})).json()["algorithms"][0];
  ASSERT_TRUE(law["feasible"].get<bool>()) << law.dump(1);
  const double error = law["error"]["inside_max_m"].get<double>();
  EXPECT_GT(error, 0.0);
  EXPECT_LE(law["metrics"]["inside_max_m"].get<double>() + error, 0.5e-3);
}

TEST_F(TuneCommand, WritesTheSameBytesHoweverManyJobs) {
  hapbench(words({"--jobs", "1", "--quiet"}, "a"));
  hapbench(words({"--jobs", "3", "--quiet"}, "b"));
  for (const char* name : {"tune.csv", "tune_trials.csv", "tap_wall_tuned.json"})
    EXPECT_EQ(read_file(directory_ / "a" / name), read_file(directory_ / "b" / name)) << name;
}

}  // namespace
}  // namespace hapbench::tune_command_test
