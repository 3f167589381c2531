#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/studies.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::sweep_test {
namespace {

namespace fs = std::filesystem;
using test::cells_of;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using test::read_file;

// Tests the results, files and output of hapbench sweep, for whole sweeps and for shards.

using Words = std::vector<std::string>;

class SweepCommand : public testing::Test {
 protected:
  /// Returns the arguments of a sweep of 24 runs in four environments. Some of the runs end early.
  Words words(const std::string& out) const {
    const std::string line =
        "peg_in_hole_2d_shaped_stiffness --set expect.metrics={} "
        R"(--set expect.outcome=["completes","leaves_hole","lost_contact","diverges"] )"
        "--vary rendering.stiffness_N_per_m=5000:20000:2 --vary environment.spacing_m=2e-5:5e-5:4:log "
        "--vary rendering.algorithm=mean,summation,exact_shaping --out";
    Words words;
    for (const std::string_view word : words_of(line)) words.emplace_back(word);
    words.push_back((directory_ / out).string());
    return words;
  }
  ProgramRun sweep(const std::string& out, const Words& more = {}) const {
    Words all = words(out);
    all.insert(all.begin(), "sweep");
    all.insert(all.end(), more.begin(), more.end());
    return hapbench(all);
  }
  std::string table(const std::string& out) const { return read_file(directory_ / out / "sweep.csv"); }
  test::TemporaryDirectory directory_;
};

/// Checks a sweep whose results cannot be written, as on a full disk: a file has the name of a run's folder.
TEST_F(SweepCommand, StartsNoFurtherRunsWhereTheyCannotBeKept) {
  fs::create_directories(directory_ / "a" / "runs");
  std::ofstream(directory_ / "a" / "runs" / "000000") << "in the way";
  const ProgramRun stopped = sweep("a", {"--keep-runs", "--jobs", "1"});
  EXPECT_EQ(stopped.status, 1);
  EXPECT_NE(stopped.err.find("000000"), std::string::npos) << stopped.err;
  EXPECT_FALSE(fs::exists(directory_ / "a" / "sweep.csv"));
  EXPECT_FALSE(fs::exists(directory_ / "a" / "runs" / "000001"));
  fs::remove(directory_ / "a" / "runs" / "000000");
  EXPECT_EQ(sweep("a", {"--keep-runs", "--resume"}).status, 0);
  sweep("b");
  EXPECT_EQ(table("a"), table("b"));
}

/// Checks stiffnesses that are so small that the tool goes through the surface. Runs that fail are results; only an
/// unmet `expect` is an error.
TEST_F(SweepCommand, CountsRunsThatFailAndEndsThemEarly) {
  const auto sweep_of = [this](const std::string& out, const Words& more) {
    Words all = {"sweep",  "mesh_molar",
                 "--vary", "rendering.stiffness_N_per_m=5,10,20000",
                 "--out",  (directory_ / out).string()};
    all.insert(all.end(), more.begin(), more.end());
    return hapbench(all);
  };
  const ProgramRun run = sweep_of("soft", {});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("2 of 3 runs failed (went_through 2), the first: run 0"), std::string::npos) << run.err;
  const auto lines = lines_of(table("soft"));
  const Words names = cells_of(lines[0]);
  const auto cell = [&](std::size_t row, const std::string& name) {
    return cells_of(lines[row])[static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())];
  };
  EXPECT_NE(cell(1, "ended_at_s"), "");
  EXPECT_EQ(cell(1, "force_max_N"), "");
  EXPECT_EQ(cell(3, "ended_at_s"), "");
  EXPECT_NE(cell(3, "force_max_N"), "");
  // With --full, the outcomes are the same, and failed runs also have values of metrics.
  ASSERT_EQ(sweep_of("full", {"--full"}).status, 0);
  const auto full = lines_of(table("full"));
  for (std::size_t row = 1; row < 4; ++row) EXPECT_EQ(cells_of(full[row])[2], cells_of(lines[row])[2]);
  EXPECT_EQ(full[3], lines[3]);
  // An unmet expectation of the user is an error.
  const ProgramRun expected = sweep_of("expected", {"--set", "expect.outcome=completes"});
  EXPECT_EQ(expected.status, 3);
  EXPECT_NE(expected.err.find("2 of 3 runs did not meet the scenario's expect"), std::string::npos) << expected.err;
}

TEST_F(SweepCommand, MeasuresEachRun) {
  const ProgramRun run = hapbench({"sweep", "poke_plane", "--vary", "rendering.algorithm=mean,summation", "--set",
                                   "time.steps=200", "--time", "--out", (directory_ / "timed").string()});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("us per"), std::string::npos) << run.out;
  const auto lines = lines_of(read_file(directory_ / "timed" / "sweep_timing.csv"));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(cells_of(lines[0])[1], "rendering.algorithm");
  EXPECT_EQ(cells_of(lines[2])[1], "summation");
  EXPECT_GT(std::stod(cells_of(lines[1])[2]), 0.0);
}

TEST_F(SweepCommand, HasTheRunsThatThePrintedCommandRepeats) {
  const ProgramRun run = sweep("a", {"--keep-runs", "--jobs", "4"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  const auto lines = lines_of(table("a"));
  ASSERT_EQ(lines.size(), 25u);
  const Words names = cells_of(lines[0]);
  EXPECT_EQ((Words{names.begin(), names.begin() + 7}),
            (Words{"index", "rendering.stiffness_N_per_m", "environment.spacing_m", "rendering.algorithm", "outcome",
                   "expected", "steps"}));
  EXPECT_EQ(names.back(), "state_hash");
  const Words cells = cells_of(lines[1 + 12 + 0 + 2]);
  EXPECT_EQ((Words{cells.begin(), cells.begin() + 4}), (Words{"14", "20000", "2e-05", "exact_shaping"}));

  const ProgramRun printed = sweep("a", {"--row", "14", "--print"});
  EXPECT_EQ(lines_of(printed.out).size(), 1u);
  // The printed command is quoted for a shell. The double quotes in the list of outcomes belong to the argument.
  EXPECT_NE(printed.out.find(" --set 'expect.outcome=[\"completes\","), std::string::npos) << printed.out;
  Words words = sweep("a", {"--row", "14", "--print", "--json"}).json()["command"].get<Words>();
  EXPECT_EQ(words[0], fs::canonical(test::hapbench_program()));
  words.erase(words.begin());
  words.insert(words.end(), {"--out", (directory_ / "run").string()});
  ASSERT_EQ(hapbench(words).status, 0);
  // The sweep and the single `run` write the same bytes, except that only `run` adds a diagnosis to summary.json. The
  // number of allocations is also the same, although other runs of the sweep run at the same time.
  test::expect_same_files(directory_ / "a/runs/000014", directory_ / "run", {"summary.json"});
  Json summary = Json::parse(read_file(directory_ / "run/summary.json"));
  EXPECT_EQ(summary.erase("diagnosis"), 1u);
  EXPECT_EQ(summary, Json::parse(read_file(directory_ / "a/runs/000014/summary.json")));
  EXPECT_EQ(summary["work"]["allocations"], 0);
  EXPECT_TRUE(fs::exists(directory_ / "a/runs/000023/trajectory.csv"));
  EXPECT_EQ(summary["outcome"], cells[4]);
  EXPECT_EQ(cells[6], std::to_string(summary["steps"].get<int>()));
  EXPECT_EQ(summary["state_hash"], cells.back());
}

TEST_F(SweepCommand, IsPrintedAgainFromItsFolder) {
  const std::string out = (directory_ / "a").string();
  for (const Words& vary : {Words{"--vary", "rendering.mass_kg=0.1:0.2:4", "--vary", "seed=1,2"},
                            Words{"--sample", "lhs:16", "--vary", "rendering.mass_kg=0.1:0.2"}}) {
    Words words = {"sweep", "springs_limited_mean", "--set", "expect={}", "--out", out};
    words.insert(words.end(), vary.begin(), vary.end());
    const ProgramRun first = hapbench(words), again = hapbench({"sweep", out});
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_EQ(again.out, first.out);
    EXPECT_EQ(again.err, first.err);
    words.emplace_back("--json");
    EXPECT_EQ(hapbench({"sweep", out, "--json"}).out, hapbench(words).out);
  }
}

TEST_F(SweepCommand, PrintsTheRunsThatKeepConditions) {
  ASSERT_EQ(sweep("a").status, 0);
  const std::string out = (directory_ / "a").string();
  Json expected = Json::array();
  const Json all = hapbench({"sweep", out, "--json"}).json()["rows"];
  for (const Json& row : all)
    if (row["force_max_N"] < 3.0 && row["rendering.algorithm"] != "mean") expected.push_back(row);
  ASSERT_GT(expected.size(), 1u);
  ASSERT_LT(expected.size(), 16u);
  const Words where = {"--where", "force_max_N<3", "--where", "rendering.algorithm!=mean"};
  Words words = {"sweep", out};
  words.insert(words.end(), where.begin(), where.end());
  // The result is the same whether the conditions are given to the sweep or to the finished table.
  const ProgramRun again = hapbench(words), first = sweep("a", where);
  EXPECT_EQ(first.out, again.out);
  const std::string says = " of 24 runs satisfy force_max_N<3 and rendering.algorithm!=mean\n";
  EXPECT_NE(again.out.find(std::to_string(expected.size()) + says), std::string::npos) << again.out;
  words.emplace_back("--json");
  EXPECT_EQ(hapbench(words).json()["rows"], expected);
  EXPECT_EQ(hapbench({"sweep", out, "--vary", "seed=1,2"}).status, 2);
  const auto lines = lines_of(table("a"));
  test::write_plainly(directory_ / "a/sweep.csv", lines[0] + "\n" + lines[2] + "\n0,1,2,3\n");
  EXPECT_NE(hapbench({"sweep", out}).err.find("allowed: rows of this sweep"), std::string::npos);
}

TEST_F(SweepCommand, VariesScenesAndWholeObjects) {
  const std::string devices = R"(device={"type":"ideal"},{"type":"impedance","preset":"touch"})";
  const ProgramRun run =
      hapbench({"sweep", "--vary", "scenario=single_spring,poke_plane", "--vary", devices, "--set", "expect={}",
                "--set", "time.steps=50", "--out", (directory_ / "a").string(), "--json"});
  const Json rows = run.json()["rows"];
  ASSERT_EQ(rows.size(), 4u) << run.err;
  EXPECT_EQ(rows[1]["scenario"], "single_spring");
  EXPECT_EQ(rows[3]["scenario"], "poke_plane");
  EXPECT_EQ(rows[3]["device"]["preset"], "touch");
  EXPECT_NE(rows[0]["state_hash"], rows[2]["state_hash"]);
  EXPECT_EQ(hapbench({"sweep", (directory_ / "a").string(), "--json"}).out, run.out);
}

/// Checks shards that are run like in Slurm: one task for each shard. One task is repeated, and the last task joins the
/// tables.
TEST_F(SweepCommand, RunsInShardsByTheScriptForSlurm) {
  const auto task = [&](const std::string& number, Words more) {
    more.insert(more.begin(), {"HAPBENCH=" + test::hapbench_program().string(), "SLURM_ARRAY_TASK_COUNT=3",
                               "SLURM_ARRAY_TASK_ID=" + number, HAPBENCH_SCENARIOS "/../../scripts/sweep.sbatch"});
    return test::run_program("/usr/bin/env", more);
  };
  for (const char* number : {"1", "1", "0", "2"}) {
    EXPECT_FALSE(fs::exists(directory_ / "it's/sweep.csv"));
    const ProgramRun run = task(number, words("it's"));
    EXPECT_EQ(run.status, 0) << run.err;
  }
  sweep("whole");
  for (const char* file : {"sweep.csv", "sweep.json"})
    EXPECT_EQ(read_file(directory_ / "it's" / file), read_file(directory_ / "whole" / file)) << file;
  const ProgramRun homeless = task("0", {"single_spring"});
  EXPECT_EQ(homeless.status, 2);
  EXPECT_NE(homeless.err.find("--out FOLDER is missing"), std::string::npos) << homeless.err;
}

TEST(SweepThreads, ThatCannotAllBeStartedEndItWithAReason) {
  const test::TemporaryDirectory directory;
  // Check threads that do not fit into memory: each thread has a stack of some megabytes.
  const ProgramRun run =
      hapbench({"sweep", "tap_wall", "--vary", "seed=1:400:400", "--jobs", "200", "--out", directory / "out"},
               {.memory_limit = std::size_t{1} << 30});
  EXPECT_EQ(run.signal, 0);
#ifndef HAPBENCH_SANITIZED  // sanitizers reserve more address space
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("if threads or memory ran short: fewer --jobs"), std::string::npos) << run.err;
#endif
}

/// Checks a scenario with 16 million points, which is valid, and a memory limit that is too small for them.
TEST(Memory, ThatIsNotThereEndsACommandWithAReason) {
#ifdef HAPBENCH_SANITIZED
  GTEST_SKIP() << "sanitizers reserve more addresses";
#endif
  const ProgramRun run =
      hapbench({"run", "poke_plane", "--set", "environment.spacing_m=1e-6"}, {.memory_limit = 500'000'000});
  EXPECT_EQ(run.signal, 0);
  EXPECT_EQ(run.status, 1);
  EXPECT_NE(run.err.find("out of memory; allowed: "), std::string::npos) << run.err;
}

// Tests the algorithms, scenarios and seeds of hapbench compare. tests/data/golden/sweep.txt has the printed texts,
// tests/known_answers the numbers.

class CompareCommand : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return (directory_ / name).string(); }

  test::TemporaryDirectory directory_;
};

TEST_F(CompareCommand, EqualsARunOfEachAlgorithmAlone) {
  const std::string scene = "peg_in_hole_2d_shaped_stiffness";
  hapbench({"compare", scene, "--algorithms", "mean", "--out", at("out")});
  hapbench({"run", scene, "--set", "rendering.algorithm=mean", "--out", at("run")});
  // Only summary.json differs: `run` checks the scenario's expectations, which are for another algorithm, and `compare`
  // does not check them. The numbers are the same.
  test::expect_same_files(directory_ / "out/mean", directory_ / "run", {"summary.json"});
}

TEST_F(CompareCommand, ReportsThatEveryRunFailed) {
  // The tool starts 100 mm above the tooth, so that no law touches the tooth.
  const Words words = {"compare",       "mesh_molar", "--algorithms", "mean,summation", "--set",
                       "time.steps=20", "--set",      "expect={}",    "--set",          "initial.position_m=[0,0,0.1]",
                       "--out",         at("out")};
  Words ranked = words;
  ranked.insert(ranked.end(), {"--by", "force_max_N"});
  const std::string message = hapbench(ranked).out;
  EXPECT_NE(message.find("nothing is ranked: every run failed"), std::string::npos) << message;
  EXPECT_EQ(message.find("rank: 1 is best"), std::string::npos) << message;
  EXPECT_NE(hapbench(words).out.find("every run failed: there is no vibration"), std::string::npos);
}

/// Compares runs of a round tip that is pressed onto a plane from two heights, with 1 and with 5 jobs.
TEST_F(CompareCommand, GivesTheSameBytesWhateverTheJobs) {
  for (const auto& [name, height] : {std::pair{"press", "0.0001"}, {"poke", "0.0003"}}) {
    test::write_plainly(directory_ / (std::string(name) + ".json"),
                        std::string(R"({"time": {"step_s": 0.0005, "steps": 100}, "tool": {"tip": "round"},
                        "environment": {"type": "plane"}, "hand": {"type": "force", "z_N": -1},
                        "initial": {"position_m": [0, 0, )") +
                            height + "]}}");
  }
  for (const char* jobs : {"1", "5"}) {
    hapbench({"compare", at("press.json"), at("poke.json"), "--algorithms", "mean, summation,proxy", "--seeds", "2",
              "--jitter", "1e-5", "--jobs", jobs, "--quiet", "--out", at(jobs)});
  }
  for (const char* name :
       {"ranking.csv", "press/comparison.csv", "poke/comparison.csv", "poke/proxy/seed_1/summary.json"})
    EXPECT_TRUE(std::filesystem::exists(directory_ / "1" / name)) << name;
  test::expect_same_files(directory_ / "1", directory_ / "5");
}

// Tests studies, which are files with a command and its options.

class Study : public testing::Test {
 protected:
  std::string file(const std::string& text) {
    test::write_plainly(directory_ / "mine.json", text);
    return (directory_ / "mine.json").string();
  }
  test::TemporaryDirectory directory_;
};

constexpr std::size_t kFirst[] = {1}, kSecond[] = {2};  // indices of positional arguments

TEST_F(Study, IsTheWordsOfItsCommand) {
  const std::string mine = file(R"({
    "ask": "limit", "scenarios": ["a", "b.json"], "summary": "s", "between": [1e2, 1e5],
    "smallest": true, "resolution": 0.01,
    "algorithms": ["mean", "proxy"], "bound": ["x=1", "y=2"], "set": {"hand": {"mass_kg": 1}, "seed": 3},
    "over": {"device.delay_samples": {"from": 0, "to": 8, "count": 5, "log": true}, "integrator.type": ["rk4", "event"],
             "device": [{"type": "ideal"}]}})");
  const auto words = StudyArguments::in({"limit", "--quiet", mine, "--resolution=0.5"}, kSecond);
  ASSERT_TRUE(words);
  EXPECT_EQ(fmt::format("{}", fmt::join(words->arguments, " ")),
            "limit a b.json --between 100:1e+05 --smallest --algorithms mean,proxy --bound x=1 --bound y=2 "
            R"(--set hand={"mass_kg":1} --set seed=3 --over device.delay_samples=0:8:5:log )"
            R"(--over integrator.type=rk4,event --over device={"type":"ideal"} --quiet --resolution=0.5)")
      << "an option that is given goes before the study's";
  test::write_plainly(directory_ / "b.json", "{}");
  EXPECT_EQ(StudyArguments::in({"limit", mine}, kFirst)->arguments[2], (directory_ / "b.json").string())
      << "beside the study";
  EXPECT_FALSE(StudyArguments::in({"limit", "single_spring"}, kFirst));
  EXPECT_FALSE(StudyArguments::in({"describe", "stability_z_width"}, kFirst));
}

TEST_F(Study, IsRefusedByAnotherCommandAndAtTheLineOfItsFault) {
  const std::string mine = file("{\n\"ask\": \"limit\",\n\"scenarios\": [\"single_spring\"],\n\"stable\": \"never\"}");
  const test::ProgramRun other = test::hapbench({"sweep", mine});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("line 2: is a question for \"hapbench limit "), std::string::npos) << other.err;
  const test::ProgramRun wrong = test::hapbench({"limit", mine, "--out", (directory_ / "out").string()});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_NE(wrong.err.find(mine + ":4: limit: --stable: "), std::string::npos) << wrong.err;
  // The message also mentions --between, which is not at fault.
  file("{\n\"ask\": \"limit\", \"scenarios\": [\"single_spring\"],\n\"between\": [1, 2],\n\"vary\": \"seed=1\"}");
  const test::ProgramRun mentioned = test::hapbench({"limit", mine, "--out", (directory_ / "out").string()});
  EXPECT_EQ(mentioned.status, 2);
  EXPECT_NE(mentioned.err.find(mine + ":4: --vary: "), std::string::npos) << mentioned.err;
}

TEST_F(Study, IsNotNamedByTheValueOfAnOption) {
  const auto expect_folder = [this](Words words, const std::string& study) {
    test::ProgramOptions options;
    options.directory = directory_.path();
    words.insert(words.end(), {"--quiet", "--set", "time.steps=20", "--set", "expect={}", "--out", study});
    const test::ProgramRun run = hapbench(words, options);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(fs::is_directory(directory_ / study)) << study;
  };
  // Each folder given to --out has the name of a bundled study of the same command.
  expect_folder({"run", "single_spring"}, "run_limits");
  expect_folder({"limit", "single_spring", "--resolution", "0.5"}, "stability_delay");
  // A study after options and their values is also found.
  const std::string mine = file(R"({"ask": "run", "scenarios": ["single_spring"], "no-skip": true})");
  expect_folder({"run", "--set", "seed=3", "--json", mine}, "sweep_out");
}

/// Options that shorten the question of a command to about a second.
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
    // The test does not check how shortened runs end.
    EXPECT_TRUE(run.status == 0 || (study.ask == "run" && run.status == 3)) << study.name << ": " << run.err;
  }
}

}  // namespace
}  // namespace hapbench::sweep_test
