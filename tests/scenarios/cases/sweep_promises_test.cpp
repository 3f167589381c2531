#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <ctime>
#include <fstream>

#include "scenarios/cases/run_sweep.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// What a sweep promises whatever happens to it: the bytes of its table, its memory, and its cost.
namespace hapbench::sweep_promises_test {
namespace {

namespace fs = std::filesystem;
using test::read_file;

SweepPlan plan_of(const Json& scenario, const std::vector<std::string>& vary, const fs::path& file) {
  std::vector<Axis> axes;
  for (const std::string& text : vary) axes.push_back(parse_axis(text));
  return plan_sweep(Cases({{file, scenario}}, {}, std::move(axes)), {2, ""});
}

/// Ends a sweep as its process would end: whatever is written stays.
struct Killed {};

class SweepPromises : public testing::Test {
 protected:
  /// Runs a sweep that is interrupted after some rows: killed, stopped by a signal, or killed amid a line.
  void interrupt(const SweepPlan& plan, SweepOptions options) {
    const std::uint64_t way = random_.below(3);
    std::uint64_t rows = random_.below(plan.cases.size());
    options.added = [&rows, way] {
      if (rows-- != 0) return;
      if (way == 0) throw Killed();
      stop_work(SIGTERM);
    };
    try {
      run_sweep(plan, options);
    } catch (const Killed&) {
    } catch (const Stopped&) {
    }
    stop_work(0);
    const fs::path file = options.table().string() + ".part";
    if (way != 2 || !fs::exists(file)) return;
    std::string text = read_file(file);
    test::write_plainly(file, text.substr(0, text.size() - std::min<std::size_t>(random_.below(9), text.size())));
  }
  void run_part(const SweepPlan& plan, const fs::path& directory, const std::optional<Shard>& shard) {
    SweepOptions options{.directory = directory, .shard = shard, .resume = true};
    for (std::uint64_t times = random_.below(4); times-- > 0;) {
      options.jobs.threads = 1 + static_cast<unsigned>(random_.below(4));
      interrupt(plan, options);
    }
    run_sweep(plan, options);
  }

  test::TemporaryDirectory directory_;
  Random random_{20261124};
};

TEST_F(SweepPromises, TheSameBytesWhateverTheJobsTheShardsAndTheKills) {
  // The environment varies in between, so the runs are not done in the order of the table.
  const SweepPlan plan =
      plan_of(test::minimal_scenario("plane"),
              {"time.steps=1:6:6", "environment.spacing_m=5e-4,4e-4", "rendering.algorithm=mean,summation,proxy"},
              directory_ / "scene.json");
  const fs::path whole = directory_ / "whole";
  fs::create_directory(whole);
  ASSERT_FALSE(run_sweep(plan, {.directory = whole}).failed);
  ASSERT_EQ(test::lines_of(read_file(whole / "sweep.csv")).size(), 37u);
  for (int attempt = 0; attempt < 40; ++attempt) {
    const fs::path out = directory_ / "out";
    fs::create_directory(out);
    const std::size_t shards = random_.below(5);
    for (std::size_t i = 0; i < shards; ++i) run_part(plan, out, Shard{i, shards});
    if (shards == 0) run_part(plan, out, std::nullopt);
    EXPECT_EQ(join_shards(out), shards > 0);
    for (const char* file : {"sweep.csv", "sweep.json"})
      ASSERT_EQ(read_file(out / file), read_file(whole / file)) << "attempt " << attempt << ", " << shards << " shards";
    fs::remove_all(out);
  }
}

TEST_F(SweepPromises, AFailedRunIsTriedAgain) {
  const fs::path shell = directory_ / "shell.csv", out = directory_ / "out", whole = directory_ / "whole";
  const auto restore = [&] { test::write_plainly(shell, read_file(test::data_directory() / "shell.csv")); };
  restore();
  const SweepPlan plan = plan_of(test::minimal_scenario("point_shell"),
                                 {"environment.file=shell.csv", "time.steps=1,2,3"}, directory_ / "scene.json");
  for (const fs::path& folder : {out, whole}) fs::create_directory(folder);
  run_sweep(plan, {.directory = whole});
  fs::remove(shell);
  SweepOptions options{.directory = out};
  run_sweep(plan, options);
  EXPECT_EQ(read_sweep(options.table()).counts.failed, 3u);
  restore();
  options.resume = true;
  EXPECT_FALSE(run_sweep(plan, options).failed);
  EXPECT_EQ(read_file(out / "sweep.csv"), read_file(whole / "sweep.csv"));
}

/// What takes seconds.
class SlowSweepPromises : public SweepPromises {};

double most_resident_bytes() {
  ::rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

TEST_F(SlowSweepPromises, TheMemoryOfAThousandRunsForAHundredTimesAsMany) {
  const auto run = [&](const char* seeds) {
    const SweepPlan plan = plan_of(test::minimal_scenario("springs"), {seeds}, "springs.json");
    run_sweep(plan, {.directory = directory_.path(), .jobs = {2, ""}});
    return most_resident_bytes();
  };
  const double few = run("seed=1:1000:1000");
  // The places of the rows in their file take 8 bytes a run; what the allocator keeps for itself varies.
  EXPECT_LT(run("seed=1:100000:100000") - few, 4e6);
}

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TEST_F(SlowSweepPromises, LittleMoreTimeThanTheSimulationsInWhicheverOrderTheAxesAreGiven) {
  const Json scene = test::minimal_scenario("block_with_hole");
  const std::vector<std::string> vary[] = {{"environment.grid_m=2e-4,1.5e-4,1e-4", "time.steps=20000:20019:20"},
                                           {"time.steps=20000:20019:20", "environment.grid_m=2e-4,1.5e-4,1e-4"}};
  for (const auto& axes : vary) {
    const SweepPlan plan = plan_of(scene, axes, directory_ / "scene.json");
    const double begun = processor_seconds();
    run_sweep(plan, {.directory = directory_.path()});
    const double sweep = processor_seconds() - begun;
    double simulations = 0.0;
    for (std::size_t run = 0; run < plan.cases.size(); ++run) {
      const LoadedScenario loaded = plan.cases.load(run);
      const auto shell = make_shell(loaded.scenario, loaded.files);
      const double before = processor_seconds();
      run_with_shell(loaded, shell);
      simulations += processor_seconds() - before;
    }
    EXPECT_LT(sweep, 1.3 * simulations) << axes.front();
  }
}

}  // namespace
}  // namespace hapbench::sweep_promises_test
