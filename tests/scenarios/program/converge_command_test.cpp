#include <gtest/gtest.h>

#include <map>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench converge and compare --errors: what they print and write.
namespace hapbench::converge_command_test {
namespace {

using Words = std::vector<std::string>;
using test::cells_of;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using test::read_file;

class ConvergeCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  Words words(const Words& more, const std::string& out = "out", const char* scene = "springs_oscillation") const {
    Words words = {"converge", scene, "--out", file(out)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  /// The columns of a table, by name.
  std::map<std::string, Words> table(const std::string& name) const {
    const Words lines = lines_of(read_file(directory_ / name)), names = cells_of(lines[0]);
    std::map<std::string, Words> columns;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const Words cells = cells_of(lines[i] + " ");  // whose last cell may be empty
      for (std::size_t c = 0; c < names.size(); ++c) columns[names[c]].push_back(cells[c]);
    }
    return columns;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ConvergeCommand, WritesWhatItPrintsHoweverManyJobs) {
  const Words metrics = {"--metric", "force_max_N,inside_max_m", "--json"};
  const Json json = hapbench(words(metrics)).json();
  ASSERT_EQ(json.size(), 2u);
  const auto orders = table("out/converge.csv"), levels = table("out/converge_levels.csv");
  EXPECT_EQ(std::stod(orders.at("observed_order")[0]), json[0]["order"]);
  EXPECT_EQ(std::stod(orders.at("low")[0]), json[0]["band"][0]);
  ASSERT_EQ(json[0]["levels"].size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(std::stod(levels.at("result")[i]), json[0]["levels"][i]["result"]);
    EXPECT_GT(json[0]["levels"][i]["seconds"], 0.0);
  }
  EXPECT_TRUE(json[1]["order"].is_null() && json[1]["band"].is_null());
  EXPECT_EQ(hapbench(words({"--metric", "force_max_N", "--json", "--jobs", "3"}, "one")).json()["metric"],
            "force_max_N")
      << "one alone is no list";
  hapbench(words({"--metric", "force_max_N,inside_max_m", "--jobs", "3", "--quiet"}, "three"));
  for (const char* name : {"converge.csv", "converge_levels.csv"})
    EXPECT_EQ(read_file(directory_ / "out" / name), read_file(directory_ / "three" / name)) << name;
}

/// The error falls as the step, by a factor of two from level to level.
TEST_F(ConvergeCommand, NamesTheCoarsestLevelThatIsEnough) {
  const auto last = [&](const char* to) {
    const std::string out = hapbench(words({"--metric", "force_max_N", "--to", to})).out,
                      head = std::string("below ") + to;
    const std::size_t at = out.find("below ");
    return at == std::string::npos ? out : out.substr(at, out.find("\n\n", at) - at);
  };
  EXPECT_EQ(last("10%").find("below 10 %: time.step_s = 0.001 ("), 0u) << last("10%");
  EXPECT_NE(last("10%").find("the coarsest that was tried"), std::string::npos);
  EXPECT_EQ(last("0.01").find("below 1 %: time.step_s = 0.00025 ("), 0u) << last("0.01");
  EXPECT_EQ(last("0.1%").find("below 0.1 %: no level is; by this order time.step_s = 2.8e-05 would be"), 0u)
      << last("0.1%");
}

TEST_F(ConvergeCommand, AComparisonSaysWhatItDoesNotKnow) {
  // Points so far apart that the tip slips between them; and a law that diverges, so that it has no number.
  const std::string unknown =
      hapbench({"compare", "plane_pressed_round", "--algorithms", "shaped_stiffness", "--errors", "--out", file("a"),
                "--set", "environment.spacing_m=0.003", "--set", "expect={}"})
          .out;
  EXPECT_NE(unknown.find("2.103 +- ?"), std::string::npos) << "force_mean_in_contact_N\n" << unknown;
  const Json json =
      hapbench({"compare", "springs_unlimited_shaped_stiffness", "--algorithms", "shaped_stiffness,summation", "--by",
                "force_max_N", "--errors", "--json", "--out", file("b")})
          .json();
  EXPECT_TRUE(json["errors"][0]["numbers"][1]["value"].is_null()) << json["errors"];
  EXPECT_TRUE(json["errors"][0]["numbers"][1]["error_estimate"].is_null());
  EXPECT_EQ(json["errors"][0]["says"], "there is nothing to compare");
}

}  // namespace
}  // namespace hapbench::converge_command_test
