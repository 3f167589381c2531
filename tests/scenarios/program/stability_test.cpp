#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench stability and stress.
namespace hapbench::stability_test {
namespace {

using Names = std::vector<std::string>;
using test::cells_of;
using test::hapbench;
using test::lines_of;
using test::number_in;
using test::ProgramRun;

class StabilityCommand : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
  std::string out_ = (directory_ / "out").string();
};

TEST_F(StabilityCommand, FindsTheThreeLimitsOfA3ThreeWays) {
  const ProgramRun run = hapbench({"stability", "single_spring", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto rows = lines_of(test::read_file(directory_ / "out/limits.csv"));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0], "case,unit,analytic,eigenvalue,simulation,damping_at_limit_N_s_per_m,lambda_max");
  const struct {
    const char *name, *unit;
    double limit, tolerance;
  } kCases[] = {{"stiffness_undamped", "N/m", 1.6e6, 1e-3},
                {"damping_alone", "N s/m", 400.0, 1e-9},
                {"stiffness_damped", "N/m", 433731.0, 1.0}};  // A.3 gives whole numbers
  for (std::size_t i = 0; i < 3; ++i) {
    const auto cells = cells_of(rows[1 + i]);
    EXPECT_EQ(cells[0], kCases[i].name);
    EXPECT_EQ(cells[1], kCases[i].unit);
    EXPECT_NEAR(number_in(cells[2]), kCases[i].limit, kCases[i].tolerance);
    EXPECT_NEAR(number_in(cells[3]), kCases[i].limit, 0.01 * kCases[i].limit);
    EXPECT_NEAR(number_in(cells[4]), kCases[i].limit, 0.01 * kCases[i].limit);
    EXPECT_EQ(cells[6], "1");
  }
  EXPECT_NEAR(number_in(cells_of(rows[3])[5]), 291.6, 0.05);
}

TEST_F(StabilityCommand, WritesRootLociThatLeaveTheUnitCircle) {
  hapbench({"stability", "single_spring", "--out", out_});
  EXPECT_EQ(test::names_below(out_), (Names{"limits.csv", "root_locus.csv", "scenario.effective.json"}));
  const auto rows = lines_of(test::read_file(directory_ / "out/root_locus.csv"));
  EXPECT_EQ(rows[0], "case,value,first_real,first_imaginary,second_real,second_imaginary,spectral_radius");
  EXPECT_GT(rows.size(), 1000u);
  std::size_t beyond = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const auto cells = cells_of(rows[i]);
    const double radius = std::max(std::hypot(number_in(cells[2]), number_in(cells[3])),
                                   std::hypot(number_in(cells[4]), number_in(cells[5])));
    ASSERT_NEAR(number_in(cells[6]), radius, 1e-14 * radius) << rows[i];
    if (radius > 1.001) ++beyond;
  }
  EXPECT_GT(beyond, rows.size() / 10);  // a fifth of the values lies beyond the limit
}

TEST_F(StabilityCommand, TellsTheLimitsOfTheScenariosIntegrator) {
  const auto limits_of = [this](const std::string& integrator) {
    const ProgramRun run =
        hapbench({"stability", "single_spring", "--set", "integrator.type=" + integrator, "--json", "--out", out_});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.json()[0]["integrator"], integrator);
    return run.json()[0]["limits"];
  };
  // No closed form, so leapfrog's is not shown either.
  const Json verlet = limits_of("velocity_verlet");
  EXPECT_EQ(verlet[2]["analytic"], nullptr);
  EXPECT_EQ(cells_of(lines_of(test::read_file(directory_ / "out/limits.csv"))[3])[2], "");
  EXPECT_NEAR(verlet[2]["simulation"].get<double>(), verlet[2]["eigenvalue"].get<double>(), 1e3);
  const Json implicit = limits_of("implicit_midpoint");
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/root_locus.csv")).size(), 1u);
  EXPECT_EQ(cells_of(lines_of(test::read_file(directory_ / "out/limits.csv"))[3])[4], "inf");
  const std::string text =
      hapbench({"stability", "single_spring", "--set", "integrator.type=implicit_euler", "--out", out_}).out;
  EXPECT_NE(text.find("implicit_euler"), std::string::npos) << text;
  EXPECT_NE(text.find("none"), std::string::npos) << text;
  EXPECT_EQ(text.find("differ"), std::string::npos) << text;
}

TEST_F(StabilityCommand, GivesEachOfSeveralScenariosADirectory) {
  const ProgramRun run = hapbench({"stability", "single_spring", "single_spring_damped", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(directory_ / "out/single_spring/limits.csv"));
  EXPECT_TRUE(std::filesystem::exists(directory_ / "out/single_spring_damped/limits.csv"));
}

TEST_F(StabilityCommand, StressCountsForcesOfEveryAlgorithm) {
  const ProgramRun run = hapbench({"stress", "--count", "2000", "--json", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  EXPECT_EQ(json.size(), algorithms().size());
  for (const Json& counts : json) {
    EXPECT_EQ(counts["sets"], 2000);
    EXPECT_EQ(counts["non_finite"], 0);
    EXPECT_EQ(counts["out_of_bound"], 0);
    EXPECT_EQ(counts["first_bad_set"], nullptr);
  }
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/stress.csv")).size(), 1 + algorithms().size());
  // The seed decides.
  const auto text = [&](const char* seed) {
    return hapbench({"stress", "--count", "50", "--seed", seed, "--json", "--out", out_}).out;
  };
  EXPECT_EQ(text("5"), text("5"));
  EXPECT_NE(text("5"), text("6"));
}

}  // namespace
}  // namespace hapbench::stability_test
