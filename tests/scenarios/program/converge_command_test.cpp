#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <map>

#include "scenarios/batch/table_file.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench converge, run --sure and compare --sure: what they print and write.
namespace hapbench::converge_command_test {
namespace {

namespace fs = std::filesystem;
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

TEST_F(ConvergeCommand, WritesWhatItPrints) {
  const Json json = hapbench(words({"--metric", "force_max_N,inside_max_m", "--json"})).json();
  ASSERT_EQ(json.size(), 2u);
  const auto orders = table("out/converge.csv"), levels = table("out/converge_levels.csv"),
             sweep = table("out/sweep.csv");
  EXPECT_EQ(orders.at("metric"), (Words{"force_max_N", "inside_max_m"}));
  const Json& force = json[0];
  EXPECT_EQ(std::stod(orders.at("observed_order")[0]), force["order"]);
  EXPECT_EQ(std::stod(orders.at("low")[0]), force["band"][0]);
  EXPECT_EQ(orders.at("asymptotic")[0], "true");
  ASSERT_EQ(force["levels"].size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(std::stod(levels.at("result")[i]), force["levels"][i]["result"]);
    EXPECT_EQ(levels.at("result")[i], sweep.at("force_max_N")[i]);
    EXPECT_GT(force["levels"][i]["seconds"], 0.0);
  }
  EXPECT_EQ(table("out/converge_levels_timing.csv").at("value").size(), 5u);
  // By the formulas, from the file.
  const auto f = [&](std::size_t i) { return force["levels"][i]["result"].get<double>(); };
  const double p = std::log2((f(2) - f(3)) / (f(3) - f(4))), rest = (f(4) - f(3)) / (std::exp2(p) - 1.0);
  EXPECT_NEAR(force["order"], p, 1e-12);
  EXPECT_NEAR(force["extrapolated"], f(4) + rest, 1e-12);
  EXPECT_NEAR(force["gci"], 1.25 * std::abs(rest / f(4)), 1e-12);
  const Json& inside = json[1];
  EXPECT_TRUE(inside["order"].is_null() && inside["extrapolated"].is_null() && inside["gci"].is_null() &&
              inside["band"].is_null());
  EXPECT_NE(inside["reason"].get<std::string>().find("has no value"), std::string::npos);
  EXPECT_EQ(hapbench(words({"--metric", "force_max_N", "--json"})).json()["metric"], "force_max_N")
      << "one alone is no list";
}

TEST_F(ConvergeCommand, WritesTheSameBytesHoweverManyJobs) {
  hapbench(words({"--jobs", "1", "--quiet"}, "a", "peg_in_hole_2d_mean"));
  hapbench(words({"--jobs", "3", "--quiet"}, "b", "peg_in_hole_2d_mean"));
  for (const char* name : {"converge.csv", "converge_levels.csv", "sweep.csv", "sweep.json"})
    EXPECT_EQ(read_file(directory_ / "a" / name), read_file(directory_ / "b" / name)) << name;
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

TEST_F(ConvergeCommand, GoesOnAfterAStop) {
  const Words long_ones = words({"--set", "time.steps=20000", "--levels", "9", "--jobs", "1"});
  {
    test::RunningProgram study(test::hapbench_program(), long_ones);
    const auto has_rows = [&] { return TableFile::rows_under_way(directory_ / "out/sweep.csv") > 2; };
    ASSERT_TRUE(study.runs_until(has_rows));
    EXPECT_EQ(study.end_by(SIGTERM), 143);
  }
  EXPECT_FALSE(fs::exists(directory_ / "out/converge.csv"));
  EXPECT_NE(hapbench(long_ones).err.find("--resume to go on"), std::string::npos);
  Words again = long_ones;
  again.insert(again.end(), {"--resume", "--json"});
  const Json levels = hapbench(again).json()["levels"];
  EXPECT_TRUE(levels[0]["seconds"].is_null()) << "it was done before";
  EXPECT_TRUE(levels[8]["seconds"].is_number());
}

/// The value is that of the run; the error is that of its level, by either.
TEST_F(ConvergeCommand, SureIsOfTheRunItself) {
  const Words scene = {"press_into_hole", "--set", "time.steps=400", "--sure", "--json"};
  Words run = {"run", "--out", file("run")},
        compare = {"compare", "--algorithms", "mean,shaped_stiffness", "--out", file("compare")};
  run.insert(run.end(), scene.begin(), scene.end());
  compare.insert(compare.end(), scene.begin(), scene.end());
  const Json one = hapbench(run).json()[0], two = hapbench(compare).json()[1];
  ASSERT_EQ(one["algorithm"], two["algorithm"]);
  EXPECT_EQ(one["sure"], two["sure"]);
  const Json& force = one["sure"]["force_max_N"];
  EXPECT_EQ(force["value"], one["metrics"]["force_max_N"]);
  EXPECT_EQ(force["error_estimate"].get<double>(),
            force["error_of_step"].get<double>() + force["error_of_spacing"].get<double>());
  for (const char* part : {"step", "spacing"}) {
    const auto rows = table(fmt::format("run/sure_{}/sweep.csv", part));
    const Words& f = rows.at("force_max_N");
    ASSERT_EQ(f.size(), 3u);
    // At least as far as the furthest of the finer runs.
    const double far =
        std::max(std::abs(std::stod(f[0]) - std::stod(f[1])), std::abs(std::stod(f[0]) - std::stod(f[2])));
    EXPECT_GE(force[fmt::format("error_of_{}", part)].get<double>(), far) << part;
    EXPECT_EQ(std::stod(f[0]), force["value"].get<double>());
  }
  EXPECT_EQ(table("run/sure_step/sweep.csv").at("steps"), (Words{"400", "800", "1600"}));
}

TEST_F(ConvergeCommand, SureSaysWhatItDoesNotKnow) {
  const std::string out = hapbench({"run", "springs_oscillation", "--sure", "--out", file("a")}).out;
  EXPECT_NE(out.find("springs have no points"), std::string::npos) << out;
  EXPECT_NE(out.find("29 +- 1"), std::string::npos) << "force_max_N\n" << out;
  // Diverges, so that it has no number; and points so far apart that the tip slips between them.
  const Json json = hapbench({"run", "single_spring_unstable", "--sure", "--json", "--out", file("b")}).json();
  EXPECT_TRUE(json[0]["sure"]["force_max_N"]["error_estimate"].is_null());
  EXPECT_TRUE(json[0]["sure"]["force_max_N"]["value"].is_null());
  const Words wide = {"run",   "plane_pressed_round",         "--sure", "--out",    file("c"),
                      "--set", "environment.spacing_m=0.003", "--set",  "expect={}"};
  const std::string unknown = hapbench(wide).out;
  EXPECT_NE(unknown.find("2.103 +- ?"), std::string::npos) << "force_mean_in_contact_N\n" << unknown;
}

}  // namespace
}  // namespace hapbench::converge_command_test
