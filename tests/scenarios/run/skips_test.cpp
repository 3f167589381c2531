#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"

/// Skipped work must not change results: with every skip off, a run writes the same bytes, but for the counted work.
/// The bundled scenarios are tested in tests/scenarios/program/bundled_scenarios_test.cpp.
namespace hapbench::skips_test {
namespace {

namespace fs = std::filesystem;

/// summary.json without the counted work, which goes out in `work`; still text, so that every digit counts.
std::string summary_without_work(const fs::path& file, Json& work) {
  Json summary = Json::parse(test::read_file(file));
  work = summary["work"];
  summary.erase("work");
  return summary.dump();
}

class WithAndWithoutSkips : public testing::Test {
 protected:
  void expect_same_results(const Json& scenario) {
    LoadedScenario loaded = read_scenario(scenario, directory_.path());
    const fs::path taken = directory_ / "taken", off = directory_ / "off";
    for (const fs::path& old : {taken, off}) fs::remove_all(old);
    run_scenario(loaded, taken, false);
    loaded.scenario.rendering.skips = Skips::off;
    run_scenario(loaded, off, false);
    test::expect_same_files(taken, off, {"summary.json", "timing.json"});
    Json work_taken, work_off;
    EXPECT_EQ(summary_without_work(taken / "summary.json", work_taken),
              summary_without_work(off / "summary.json", work_off));
    EXPECT_EQ(work_off["steps_skipped"], 0);
    EXPECT_EQ(work_off["lists_rebuilt"], 0);
    EXPECT_EQ(work_off["allocations"], work_taken["allocations"]);
    skipped_ += work_taken["steps_skipped"].get<std::uint64_t>();
  }

  test::TemporaryDirectory directory_;
  std::uint64_t skipped_ = 0;
};

// Free air, touch and free air again, through every algorithm with and without damping and friction.
TEST_F(WithAndWithoutSkips, EveryAlgorithmGivesTheSameBytes) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const char* friction : {"0", "5"}) {
      SCOPED_TRACE(std::string(algorithm.info->name) + " with friction " + friction);
      Json json = Json::parse(std::string(R"({
          "time": {"step_s": 0.0005, "steps": 600}, "environment": {"type": "hole_2d"},
          "initial": {"position_m": [0.0001, 0.001, 0], "velocity_m_per_s": [0, -0.05, 0]},
          "motion": {"orientation": {"tilt_rad": {"type": "ramp", "start": 0.3, "rate_per_s": -1}}},
          "hand": {"type": "force", "y_N": {"type": "sine", "mean": 0, "amplitude": 2, "period_s": 0.1}},
          "record": {"contacts": true},
          "rendering": {"friction": {"mu_s_N_s_per_m": )") +
                              friction + R"(, "mu_f_s_per_m": )" + friction + "}}}");
      json["rendering"]["algorithm"] = algorithm.info->name;
      expect_same_results(json);
    }
  }
  EXPECT_GT(skipped_, 0u);
}

}  // namespace
}  // namespace hapbench::skips_test
