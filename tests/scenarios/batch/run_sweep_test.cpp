#include "scenarios/batch/run_sweep.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "scenarios/batch/journal.hpp"
#include "scenarios/batch/sweep_table.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/batch/sweeps.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::run_sweep_test {
namespace {

namespace fs = std::filesystem;
using test::minimal_scenario;
using test::plan_of;
using test::read_file;

using Numbers = std::vector<std::size_t>;

TEST(RunsToDo, AreInOrderWhereTheEnvironmentStaysTheSame) {
  const SweepPoints points({parse_axis("a=1,2"), parse_axis("b=1,2")});
  EXPECT_EQ(runs_to_do(points, {}), (Numbers{0, 1, 2, 3}));
  EXPECT_EQ(runs_to_do(points, {1, 3}), Numbers{1});
  EXPECT_EQ(runs_to_do(points, {4, 5}), Numbers{});
}

TEST(RunsToDo, OfOneEnvironmentFollowEachOther) {
  const SweepPoints points(
      {parse_axis("a=1,2"), parse_axis("environment.spacing_m=1e-3,2e-3,3e-3"), parse_axis("environment.width_m=1,2")});
  EXPECT_EQ(runs_to_do(points, {}), (Numbers{0, 6, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11}));
  EXPECT_EQ(runs_to_do(points, {1, 2}), (Numbers{1, 7, 3, 9, 5, 11}));
}

TEST(RunsToDo, OfASampleFollowEachOtherByTheListedFields) {
  const SweepPoints points({parse_sampled_axis("environment.file=x.stl,y.stl"),
                            parse_sampled_axis("environment.scale=1:2"), parse_sampled_axis("a=1:2")},
                           {SamplingMethod::latin_hypercube, 40, 1});
  const Numbers all = runs_to_do(points, {});
  Numbers sorted = all;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(sorted[i], i);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(points.value(all[i], 0), i < 20 ? "x.stl" : "y.stl");
}

// ---- Sweeps

class RunSweep : public testing::Test {
 protected:
  SweepReport run(const SweepPlan& plan, const fs::path& directory, bool resume = false) const {
    fs::create_directories(directory);
    SweepOptions options;
    options.directory = directory;
    options.jobs = 3;
    options.resume = resume;
    return run_sweep(plan, options);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(RunSweep, HasForEachRunWhatTheRunAloneHas) {
  Json scenario = minimal_scenario("hole_2d");
  scenario["initial"] = {{"position_m", {0.0004, -0.001, 0.0}}};
  const SweepPlan plan =
      plan_of(scenario, {"environment.spacing_m=0.0001,0.00012", "rendering.algorithm=mean,tandpasta"});
  const SweepReport report = run(plan, directory_.path());
  ASSERT_EQ(report.rows.size(), 4u);
  EXPECT_EQ(report.counts.runs, 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    const RunReport alone = run_scenario(scenario_of(plan, i), std::nullopt, false);
    EXPECT_EQ(row_text(plan, report.rows[i]), row_text(plan, sweep_row(plan, i, alone.summary)));
    EXPECT_GT(alone.summary.metrics.force_max, 0.0);
  }
}

TEST_F(RunSweep, HasOneTableWhateverTheOrderOfTheRuns) {
  // The environment varies fastest, so its runs are not done in the order of the table.
  const SweepPlan plan = plan_of(minimal_scenario("plane"), {"time.steps=1:40:40", "environment.spacing_m=5e-4,4e-4"});
  const SweepReport report = run(plan, directory_.path());
  ASSERT_EQ(report.rows.size(), 80u);
  for (std::size_t i = 0; i < 80; ++i) EXPECT_EQ(report.rows[i].run, i);
}

TEST_F(RunSweep, OfManyRunsKeepsNoRows) {
  const SweepPlan plan = plan_of(minimal_scenario("springs"), {"seed=1:10001:10001"});
  const SweepReport report = run(plan, directory_.path());
  EXPECT_EQ(report.done, 10'001u);
  EXPECT_EQ(report.counts.runs, 10'001u);
  EXPECT_TRUE(report.rows.empty());
  const auto lines = test::lines_of(read_file(report.table));
  ASSERT_EQ(lines.size(), 10'002u);
  for (std::size_t i = 0; i < 10'001; i += 100) EXPECT_EQ(parse_row(plan, lines[1 + i]).value().run, i);
}

TEST_F(RunSweep, HasErrorRowsForRunsThatNobodyChecked) {
  // Of so many values not every one is looked at before the first run; 4567 is no seed that is checked.
  std::string seeds = "seed=0";
  for (int i = 1; i < 6000; ++i) seeds += "," + std::to_string(i == 4567 ? -1 : i);
  const SweepPlan plan = plan_of(minimal_scenario("springs"), {seeds});
  const SweepReport report = run(plan, directory_.path());
  EXPECT_EQ(report.counts.failed, 1u);
  ASSERT_TRUE(report.failed);
  EXPECT_EQ(report.failed->run, 4567u);
  EXPECT_NE(report.failed->problem.find("/seed: got -1"), std::string::npos) << report.failed->problem;
  EXPECT_EQ(row_text(plan, report.rows[4567]), row_text(plan, error_row(plan, 4567)));
}

TEST_F(RunSweep, LeavesTheTableAndItsDescriptionOnly) {
  const SweepPlan plan = plan_of(minimal_scenario("plane"), {"time.steps=1,2"});
  const SweepReport report = run(plan, directory_.path());
  EXPECT_EQ(directory_.entries(), (std::vector<std::string>{"sweep.csv", "sweep.json"}));
  EXPECT_EQ(read_file(report.table),
            sweep_header(plan) + "\n" + row_text(plan, report.rows[0]) + "\n" + row_text(plan, report.rows[1]) + "\n");
  const Json description = Json::parse(read_file(directory_ / "sweep.json"));
  EXPECT_EQ(description["definition"], plan.definition);
  EXPECT_EQ(description["vary"][0]["values"], (Json{"1", "2"}));
}

/// A sweep of a scenario whose file is there when it is planned.
class FailingSweep : public RunSweep {
 protected:
  FailingSweep() {
    restore();
    plan_ = plan_of(minimal_scenario("point_shell"), {"environment.file=a.csv,b.csv", "time.steps=1,2"},
                    directory_ / "sweep.json");
  }
  void restore() const {
    for (const char* name : {"a.csv", "b.csv"}) {
      test::write_plainly(directory_ / name, read_file(test::data_directory() / "shell.csv"));
    }
  }
  std::optional<SweepPlan> plan_;
};

TEST_F(FailingSweep, HasErrorRowsForWhatFailsAndGoesOn) {
  fs::remove(directory_ / "a.csv");
  const SweepReport report = run(*plan_, directory_ / "out");
  ASSERT_EQ(report.rows.size(), 4u);
  ASSERT_TRUE(report.failed);
  EXPECT_EQ(report.failed->run, 0u);
  EXPECT_NE(report.failed->problem.find("a.csv"), std::string::npos);
  EXPECT_EQ(row_text(*plan_, report.rows[1]), row_text(*plan_, error_row(*plan_, 1)));
  EXPECT_EQ(row_text(*plan_, report.rows[2]).find("2,b.csv,1,completes,true,1,"), 0u);
  for (const SweepRow& row : report.rows) {
    EXPECT_EQ(test::cells_of(row_text(*plan_, row)).size(), test::cells_of(sweep_header(*plan_)).size());
  }
}

TEST_F(FailingSweep, TriesWhatFailedAgainWhenItIsResumed) {
  run(*plan_, directory_ / "whole");
  fs::remove(directory_ / "a.csv");
  run(*plan_, directory_ / "out");
  restore();
  // A sweep that was stopped when everything had been tried: the journal has the rows that did not fail.
  const std::string title = "definition " + plan_->definition + ", shard 0/1, runs are not kept";
  {
    Journal journal(directory_ / "out/sweep.journal", title, false);
    const auto rows = test::lines_of(read_file(directory_ / "out/sweep.csv"));
    journal.add(rows[3]);
    journal.add(rows[4]);
  }
  const SweepReport report = run(*plan_, directory_ / "out", true);
  EXPECT_EQ(report.resumed, 2u);
  EXPECT_FALSE(report.failed);
  EXPECT_EQ(read_file(directory_ / "out/sweep.csv"), read_file(directory_ / "whole/sweep.csv"));
}

TEST_F(RunSweep, TakesNoRowsFromItsJournalThatAreNotItsOwn) {
  const SweepPlan plan = plan_of(minimal_scenario("plane"), {"time.steps=1,2"});
  const std::string title = "definition " + plan.definition + ", shard 0/1, runs are not kept";
  const std::string good = row_text(plan, run(plan, directory_.path()).rows[0]);
  for (const std::string& row : {std::string("2") + good.substr(1), "0,7" + good.substr(3), std::string("x"),
                                 std::string(","), good + ",", std::string("99999999999999999999,1")}) {
    Journal(directory_ / "sweep.journal", title, false).add(row);
    EXPECT_TRUE(test::input_error_of([&] { run(plan, directory_.path(), true); })) << row;
  }
}

}  // namespace
}  // namespace hapbench::run_sweep_test
