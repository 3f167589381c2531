#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench converge and compare --errors: what they print and write.
namespace hapbench::converge_command_test {
namespace {

using Words = std::vector<std::string>;
using test::hapbench;
using test::ProgramRun;
using test::read_file;

class ConvergeCommand : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  ProgramRun converge(const Words& more, const std::string& out = "out") const {
    Words words = {"converge", "springs_oscillation", "--out", file(out), "--metric"};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(ConvergeCommand, WritesTheSameBytesHoweverManyJobs) {
  const Json json = converge({"force_max_N,inside_max_m", "--json"}, "one").json();
  ASSERT_EQ(json.size(), 2u);
  for (const Json& level : json[0]["levels"]) EXPECT_GT(level["seconds"], 0.0);
  EXPECT_TRUE(json[1]["order"].is_null() && json[1]["band"].is_null());
  EXPECT_EQ(converge({"force_max_N", "--json"}).json()["metric"], "force_max_N") << "one alone is no list";
  converge({"force_max_N,inside_max_m", "--jobs", "3", "--quiet"}, "three");
  for (const char* name : {"converge.csv", "converge_levels.csv"})
    EXPECT_EQ(read_file(directory_ / "one" / name), read_file(directory_ / "three" / name)) << name;
}

/// The error falls as the step, by a factor of two from level to level.
TEST_F(ConvergeCommand, NamesTheCoarsestLevelThatIsEnough) {
  for (const auto& [to, said] :
       {std::pair{"0.01", "\nbelow 1 %: time.step_s = 0.00025 ("},
        {"0.1%", "\nbelow 0.1 %: no level is; by this order time.step_s = 2.8e-05 would be"}}) {
    const std::string out = converge({"force_max_N", "--to", to}).out;
    EXPECT_NE(out.find(said), std::string::npos) << out;
  }
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
