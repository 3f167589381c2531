#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::timing_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::hapbench;
using test::ProgramRun;
using test::read_file;

// Tests the measured run times of laws (compare --time) and of settings (converge --over).

TEST(Timing, OfLawsIsInATableOfItsOwn) {
  const test::TemporaryDirectory directory;
  const auto out = [&directory](const char* name) { return (directory / name).string(); };
  const std::vector<std::string> laws = {"compare", "tap_wall", "--algorithms", "mean,proxy", "--json"};
  const auto with = [&laws](std::vector<std::string> more) {
    more.insert(more.begin(), laws.begin(), laws.end());
    return more;
  };
  const ProgramRun plain = hapbench(with({"--out", out("plain")}));
  const ProgramRun timed = hapbench(with({"--out", out("timed"), "--time"}));
  ASSERT_EQ(timed.status, 0) << timed.err;
  EXPECT_EQ(read_file(directory / "plain/comparison.csv"), read_file(directory / "timed/comparison.csv"));
  EXPECT_FALSE(fs::exists(directory / "plain/comparison_timing.csv"));
  const json answer = json::parse(timed.out);
  ASSERT_EQ(answer["times"].size(), 2u);
  EXPECT_EQ(answer["runs"], json::parse(plain.out)) << "the runs are the same";
  EXPECT_EQ(answer["times"][0]["rank"], 1);
  for (const json& law : answer["times"]) {
    EXPECT_GT(law["seconds_per_step"], 0.0);
    EXPECT_GE(law["spread_s"], 0.0);
  }
  // Without --time, the table of an earlier comparison is removed.
  ASSERT_EQ(hapbench(with({"--out", out("timed")})).status, 0);
  EXPECT_FALSE(fs::exists(directory / "timed/comparison_timing.csv"));
}

TEST(Timing, IsAMetricOfARanking) {
  const test::TemporaryDirectory directory;
  const ProgramRun run = hapbench({"compare", "tap_wall", "--algorithms", "mean,proxy", "--by", "time,force_max_N",
                                   "--json", "--out", (directory / "out").string()});
  ASSERT_EQ(run.status, 0) << run.err;
  const json answer = json::parse(run.out);
  EXPECT_EQ(answer["times"].size(), 2u);
  for (const json& entry : answer["ranking"]) EXPECT_EQ(entry["metric"], "force_max_N");
}

TEST(Timing, OfSettingsHasErrorsThatDoNotDependOnTheRun) {
  const test::TemporaryDirectory directory;
  const std::string out = (directory / "out").string();
  const std::vector<std::string> words = {"converge", "single_spring",
                                          "--over",   "integrator.type=leapfrog,rk4",
                                          "--set",    "rendering.stiffness_N_per_m=500",
                                          "--levels", "3",
                                          "--out",    out};
  const ProgramRun first = hapbench(words);
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_NE(first.out.find("ms per simulated second"), std::string::npos) << first.out;
  const std::string errors = read_file(directory / "out/convergence.csv");
  EXPECT_EQ(std::ranges::count(errors, '\n'), 7) << "a header, and three steps of two integrators";
  ASSERT_EQ(hapbench(words).status, 0);
  EXPECT_EQ(read_file(directory / "out/convergence.csv"), errors);
  for (const auto& [option, value] : {std::pair{"--vary", "environment.spacing_m"},
                                      {"--metric", "force_max_N"},
                                      {"--to", "1%"},
                                      {"--over", "no.such=1"}}) {
    std::vector<std::string> wrong = words;
    wrong.insert(wrong.end(), {option, value});
    EXPECT_EQ(hapbench(wrong).status, 2) << option;
  }
}

/// Checks a study whose reference solution is known to 0.2 um only, because velocity_verlet converges slowly with
/// damping. The errors of rk4 are far smaller, but are not shown to be below 0.1 um.
TEST(Timing, OfSettingsDoesNotCallAnUnresolvedErrorLarge) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "damped.json", R"({"name": "damped", "time": {"step_s": 0.0005, "duration_s": 0.4},
    "environment": {"type": "springs", "bilateral": true, "groups": [{"direction": [1, 0, 0], "count": 1}]},
    "initial": {"position_m": [0.005, 0, 0]},
    "rendering": {"algorithm": "summation", "stiffness_N_per_m": 2000, "damping_ratio": 0.1, "mass_kg": 0.1,
                  "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}})");
  const auto study = [&](const char* to) {
    const ProgramRun run =
        hapbench({"converge", (directory / "damped.json").string(), "--over", "integrator.type=rk4,velocity_verlet",
                  "--levels", "3", "--to", to, "--out", (directory / "out").string()});
    EXPECT_EQ(run.status, 0) << run.err;
    return run.out;
  };
  const std::string fine = study("1e-7"), coarse = study("1e-6");
  EXPECT_NE(fine.find("no setting is shown to be below 1e-07 m, because the reference is known to"), std::string::npos)
      << fine;
  EXPECT_NE(coarse.find("the cheapest setting below 1e-06 m is rk4 at 0.0005 s"), std::string::npos) << coarse;
}

}  // namespace
}  // namespace hapbench::timing_test
