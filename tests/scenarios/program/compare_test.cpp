#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// hapbench compare: of algorithms, of scenarios and seeds.
namespace hapbench::compare_test {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;
using test::cells_of;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;

class CompareCommand : public testing::Test {
 protected:
  ProgramRun compare(std::vector<std::string> more) const {
    more.insert(more.begin(), {"compare", "peg_in_hole_2d_shaped_stiffness", "--out", out_});
    return hapbench(more);
  }
  test::TemporaryDirectory directory_;
  std::string out_ = (directory_ / "out").string();
};

TEST_F(CompareCommand, ShowsARowForEachAlgorithm) {
  const ProgramRun run = compare({"--algorithms", "original_averaging,mean,exact_shaping"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto lines = lines_of(run.out);
  ASSERT_EQ(lines.size(), 15u) << run.out;
  EXPECT_EQ(lines[0], "peg_in_hole_2d_shaped_stiffness");
  EXPECT_EQ(lines[3].find("algorithm          outcome"), 0u);
  EXPECT_EQ(lines[5].find("original_averaging leaves_hole"), 0u);
  EXPECT_EQ(lines[6].find("mean               leaves_hole"), 0u);
  EXPECT_EQ(lines[7].find("exact_shaping      leaves_hole"), 0u);
  EXPECT_EQ(lines[9],
            "\"-\": under 1/30 s of settled contact (original_averaging); --set metrics.from_s=0 takes all contact");
  EXPECT_EQ(lines[11].find("99 % of the steps take at most "), 0u) << lines[11];
  EXPECT_EQ(lines[12], "defined with a depth model of their own: original_averaging with shortest_distance");
}

TEST_F(CompareCommand, NamesTheAlgorithmsWhoseFrictionTheIntegratorCannotStep) {
  EXPECT_EQ(
      compare({"--algorithms", "mean,summation,tandpasta"}).err,
      "hapbench: warning: peg_in_hole_2d_shaped_stiffness: beyond 79.5 N of spring force, in 2 of 5 rows, "
      "first in step 0, the explicit step of friction is unstable; what follows is the integrator's doing, not the "
      "law's (summation; likewise tandpasta)\n");
  EXPECT_EQ(compare({"--algorithms", "mean"}).err, "");
  const std::string implicit = compare({"--algorithms", "summation", "--set", "integrator.type=implicit_euler"}).err;
  EXPECT_EQ(implicit.find("friction"), std::string::npos) << implicit;
}

TEST_F(CompareCommand, WritesTheTableOfTheNumbersOfEachSummary) {
  compare({"--algorithms", "mean,summation"});
  const auto lines = lines_of(test::read_file(directory_ / "out/comparison.csv"));
  ASSERT_EQ(lines.size(), 3u);
  const auto names = cells_of(lines[0]), cells = cells_of(lines[1] + ' ');  // whose last cells are empty
  const Json summary = Json::parse(test::read_file(directory_ / "out/mean/summary.json"));
  EXPECT_EQ(lines[1].find(fmt::format("mean,{},{},", summary["outcome"].get<std::string>(), summary["steps"].dump())),
            0u);
  ASSERT_EQ(cells.size(), names.size());
  for (std::size_t i = 3; i < names.size() && !names[i].starts_with("fidelity."); ++i) {
    const Json& metric = summary["metrics"].at(names[i]);
    const auto number = metric.is_null() ? std::nullopt : std::optional(metric.get<double>());
    EXPECT_EQ(cells[i].empty() ? std::nullopt : std::optional(test::number_in(cells[i])), number) << names[i];
  }
}

TEST_F(CompareCommand, EqualsARunOfEachAlgorithmAlone) {
  compare({"--algorithms", "mean"});
  hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--set", "rendering.algorithm=mean", "--out",
            (directory_ / "run").string()});
  // The run misses the expectations of another algorithm, which compare does not ask about; the numbers are the same.
  test::expect_same_files(directory_ / "out/mean", directory_ / "run", {"summary.json"});
}

TEST_F(CompareCommand, TakesOverridesJsonAndQuiet) {
  const Json json = compare({"--algorithms", "mean,summation", "--set", "time.steps=3", "--json"}).json();
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["algorithm"], "mean");
  EXPECT_EQ(json[1]["steps"], 3);
  const ProgramRun quiet = compare({"--algorithms", "mean", "--quiet"});
  EXPECT_EQ(quiet.out + quiet.err, "");
}

TEST_F(CompareCommand, ExitsWith3WhenOneDivergesUnexpectedly) {
  const ProgramRun run = hapbench(
      {"compare", "springs_unlimited_shaped_stiffness", "--algorithms", "shaped_stiffness,summation", "--out", out_});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("summation diverges at step "), std::string::npos) << run.err;
  EXPECT_EQ(lines_of(run.err).size(), 1u);
}

/// A bur along a molar's fissure, its points 0.25 mm apart: summation, whose stiffness grows with the number of points,
/// is the smoothest there and hammers at half of that.
TEST_F(CompareCommand, SaysThatTheSamplingMakesTheWinner) {
  const auto with = [this](const std::string& more) {
    return hapbench({"compare", "bur_fissure", "--set", "environment.spacing_m=0.00025", "--algorithms",
                     "shaped_stiffness,summation", "--out", out_, "--errors", more});
  };
  const Json json = with("--json").json();
  ASSERT_EQ(json["runs"].size(), 2u);
  ASSERT_EQ(json["errors"].size(), 7u) << "the numbers of the printed table";
  for (const Json& row : json["errors"]) {
    EXPECT_EQ(row["order"].size(), row["says"].get<std::string>().starts_with("the order holds") ? 2u : 1u) << row;
    EXPECT_EQ(row["numbers"][0]["value"], json["runs"][0]["metrics"][row["metric"]]);
    if (row["metric"] == "force_step_p99_N") {
      EXPECT_EQ(row["says"], "no order holds: summation ~ shaped_stiffness");
    }
  }
  const std::string text = with("--wide").out;
  EXPECT_NE(text.find("\nforce_step_p99_N: no order holds: summation ~ shaped_stiffness\n"), std::string::npos) << text;
}

/// Comparisons of several scenarios or seeds.
class CompareBatch : public testing::Test {
 protected:
  CompareBatch() {
    for (const char* name : {"press", "poke"}) {
      // A round tip pressed onto a plane, from two heights.
      test::write_plainly(directory_ / (std::string(name) + ".json"),
                          std::string(R"({"time": {"step_s": 0.0005, "steps": 100}, "tool": {"tip": "round"},
                              "environment": {"type": "plane"}, "hand": {"type": "force", "z_N": -1},
                              "initial": {"position_m": [0, 0, )") +
                              (name == std::string("press") ? "0.0001" : "0.0003") + "]}}");
    }
  }
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  ProgramRun compare(const std::string& out, const Words& more = {}) const {
    Words words = {"compare", file("press.json"), file("poke.json"),      "--out",
                   file(out), "--algorithms",     "mean, summation,proxy"};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(CompareBatch, ShowsALeagueWithinAHundredColumns) {
  const ProgramRun run = compare("out", {"--by", "force_max_N,depth_max_m"});
  EXPECT_EQ(run.status, 0) << run.err;
  for (const char* text : {"A  press\n", "B  poke\n", "\nforce_max_N, less is better\n", "\ndepth_max_m, less",
                           "\nall metrics and scenarios\n", "one seed: no spread is known", "results in "}) {
    EXPECT_NE(run.out.find(text), std::string::npos) << text << run.out;
  }
  for (const std::string& line : lines_of(run.out)) {
    if (line.starts_with("results in")) continue;  // the path is the test's
    EXPECT_LE(line.size(), 100u) << line;
  }
}

TEST_F(CompareBatch, GivesTheSameBytesWhateverTheJobs) {
  for (const char* jobs : {"1", "2", "5"})
    compare(jobs, {"--seeds", "2", "--jitter", "1e-5", "--jobs", jobs, "--quiet"});
  for (const char* name :
       {"league.csv", "press/comparison.csv", "poke/comparison.csv", "poke/proxy/seed_1/summary.json"})
    EXPECT_TRUE(fs::exists(directory_ / "1" / name)) << name;
  test::expect_same_files(directory_ / "1", directory_ / "2");
  test::expect_same_files(directory_ / "1", directory_ / "5");
}

TEST_F(CompareBatch, SaysThatNothingIsRandomAndOffersJitter) {
  const std::string alike = compare("out", {"--seeds", "3", "--by", "force_max_N"}).out;
  EXPECT_NE(alike.find("nothing is random in A B: all seeds are one run"), std::string::npos) << alike;
  EXPECT_NE(alike.find("--jitter METRES"), std::string::npos);
  const ProgramRun shifted = compare("out", {"--seeds", "3", "--by", "force_max_N", "--jitter", "2e-5", "--json"});
  for (const Json& row : shifted.json()["standings"]) EXPECT_GT(row["spread"], 0.0) << row;
  EXPECT_EQ(shifted.json()["runs"].size(), 18u);
}

TEST_F(CompareBatch, GoesOnAfterADivergence) {
  const ProgramRun run = hapbench({"compare", file("press.json"), "springs_unlimited_shaped_stiffness", "--out",
                                   file("out"), "--algorithms", "summation,shaped_stiffness", "--json"});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(lines_of(run.err).back().find("1 of 4 runs diverge, the first: "), std::string::npos) << run.err;
  const Json json = run.json();
  EXPECT_EQ(json["runs"].size(), 4u);
  const auto summation = std::find_if(json["laws"].begin(), json["laws"].end(),
                                      [](const Json& law) { return law["algorithm"] == "summation"; });
  // The press throws its tool out with the sum of all springs.
  EXPECT_EQ((*summation)["fails"], Json({"press", "springs_unlimited_shaped_stiffness"}));
}

TEST_F(CompareBatch, LeavesNothingOfAnEarlierOne) {
  compare("out", {"--quiet"});
  test::write_plainly(directory_ / "out/mine.txt", "mine");
  hapbench({"compare", file("press.json"), "--out", file("out"), "--algorithms", "proxy", "--quiet"});
  const Words names = test::names_below(directory_ / "out");
  for (const std::string& name : names) {
    EXPECT_TRUE(name.starts_with("proxy/") || name == "comparison.csv" || name == "mine.txt" ||
                name == "hapbench_results.json")
        << name;
  }
  EXPECT_TRUE(fs::exists(directory_ / "out/mine.txt"));
}

}  // namespace
}  // namespace hapbench::compare_test
