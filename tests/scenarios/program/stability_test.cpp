#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/registry.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench stability: limits, maps and stress.
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

/// `hapbench stability --map` and `--stress` through the program.
class StabilityExperiments : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
  std::string out_ = (directory_ / "out").string();
};

TEST_F(StabilityExperiments, MapsAreWrittenPointByPointAndEdgeByEdge) {
  const ProgramRun run = hapbench(
      {"stability", "--map", "wedge,device", "--algorithms", "summation,exact_shaping", "--size", "3", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(test::names_below(out_), (Names{"stability_boundary_device.csv", "stability_boundary_wedge.csv",
                                            "stability_map_device.csv", "stability_map_wedge.csv"}));
  const auto points = lines_of(test::read_file(directory_ / "out/stability_map_wedge.csv"));
  EXPECT_EQ(points[0],
            "algorithm,wedge_angle_rad,stiffness_N_per_m,class,lambda_max,stability_margin,integrator,class_from_far,"
            "overrides");
  EXPECT_EQ(points.size(), 1u + 2 * 9);
  const auto edges = lines_of(test::read_file(directory_ / "out/stability_boundary_wedge.csv"));
  EXPECT_EQ(edges[0],
            "algorithm,wedge_angle_rad,analytic_stiffness_N_per_m,simulation_stiffness_N_per_m,relative_difference,"
            "no_theory,integrator,worst_hand_stiffness_N_per_m,passive_colgate_schenkel_stiffness_N_per_m,"
            "passive_with_delay_stiffness_N_per_m,stable_gil_hulin_stiffness_N_per_m,"
            "passive_abbott_okamura_stiffness_N_per_m,exact_undamped_handle_stiffness_N_per_m,"
            "tangent_stiffness_N_per_m,overrides");
  ASSERT_EQ(edges.size(), 1u + 2 * 3);
  for (std::size_t i = 1; i < edges.size(); ++i) {
    const auto cells = cells_of(edges[i]);
    EXPECT_LE(std::abs(test::number_in(cells[4])), 0.02) << edges[i];
  }
  // The loop of the device has eigenvalues.
  const auto device = lines_of(test::read_file(directory_ / "out/stability_boundary_device.csv"));
  EXPECT_GT(test::number_in(cells_of(device[1])[2]), 0.0) << device[1];
}

TEST_F(StabilityExperiments, WhatHasNoTheorySaysWhyAndHasRunsFromFar) {
  const ProgramRun run =
      hapbench({"stability", "--map", "friction_quantisation", "--algorithms", "mean", "--size", "3", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("from 1000 times as far"), std::string::npos) << run.out;
  const auto edges = lines_of(test::read_file(directory_ / "out/stability_boundary_friction_quantisation.csv"));
  EXPECT_EQ(cells_of(edges[1])[2], "");
  EXPECT_NE(edges[1].find("not linear"), std::string::npos) << edges[1];
  const auto points = lines_of(test::read_file(directory_ / "out/stability_map_friction_quantisation.csv"));
  EXPECT_EQ(cells_of(points[1])[7], "diverged");
}

TEST_F(StabilityExperiments, MapsAreOfADeviceOfOnesOwn) {
  const auto edges = [&](const Names& overrides) {
    Names words = {"stability", "--map", "delay", "--algorithms", "summation", "--size", "3", "--json", "--out", out_};
    for (const std::string& override : overrides) words.insert(words.end(), {"--set", override});
    const ProgramRun run = hapbench(words);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.json()[0];
  };
  const Json own = edges({}), same = edges({"device.handle_mass_kg=0.1"}), heavy = edges({"device.handle_mass_kg=0.2"});
  EXPECT_EQ(heavy["overrides"], Json::array({"device.handle_mass_kg=0.2"}));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(same["boundary"][i]["analytic"], own["boundary"][i]["analytic"]);
    EXPECT_GT(heavy["boundary"][i]["analytic"], own["boundary"][i]["analytic"]);
    EXPECT_EQ(same["boundary"][i]["simulation"], own["boundary"][i]["simulation"]);
    // As of the map's own device: both are linear.
    EXPECT_LE(std::abs(heavy["boundary"][i]["relative_difference"].get<double>()), 0.01);
  }
  // Half the step is half the delay. And the axis holds, whatever a whole device says of it.
  const Json fast = edges({"time.step_s=0.0005"});
  const Json whole =
      edges({R"(device={"type":"impedance","handle_mass_kg":0.1,"viscous_N_s_per_m":0.5,"delay_samples":7})"});
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GT(fast["boundary"][i]["analytic"], own["boundary"][i]["analytic"]);
    EXPECT_LE(std::abs(fast["boundary"][i]["relative_difference"].get<double>()), 0.01);
    EXPECT_EQ(whole["boundary"][i]["analytic"], own["boundary"][i]["analytic"]);
  }
  const ProgramRun drawn = hapbench({"stability", "--map", "z_width", "--algorithms", "mean", "--size", "3", "--out",
                                     out_, "--set", "device={\"type\": \"impedance\",\n\"preset\": \"omega.3\"}"});
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_NE(drawn.out.find(R"(but device={"type":"impedance","preset":"omega.3"})"), std::string::npos) << drawn.out;
  const std::string table = test::read_file(directory_ / "out/stability_boundary_z_width.csv");
  EXPECT_NE(table.find(R"("device={""type"":""impedance"",""preset"":""omega.3""}")"), std::string::npos) << table;
  EXPECT_NE(table.find("not linear"), std::string::npos) << table;
}

TEST_F(StabilityExperiments, OneAlgorithmsMapIsDrawn) {
  const ProgramRun run =
      hapbench({"stability", "--map", "time_step", "--algorithms", "mean", "--size", "7", "--out", out_});
  EXPECT_NE(run.out.find(" . = # "), std::string::npos) << run.out;
  EXPECT_NE(run.out.find(" . . "), std::string::npos);
  EXPECT_NE(run.out.find(" # # "), std::string::npos);
  const Json json =
      hapbench({"stability", "--map", "time_step", "--algorithms", "mean", "--size", "2", "--json", "--out", out_})
          .json();
  EXPECT_EQ(json[0]["map"], "time_step");
  EXPECT_EQ(json[0]["boundary"].size(), 2u);
  EXPECT_EQ(hapbench({"stability", "--map", "mass", "--size", "2", "--quiet", "--out", out_}).out, "");
}

TEST_F(StabilityExperiments, MapsCompareIntegrators) {
  const ProgramRun run = hapbench({"stability", "--map", "time_step", "--algorithms", "mean", "--integrators", "all",
                                   "--size", "2", "--json", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  ASSERT_EQ(json.size(), kIntegrators.size());
  EXPECT_EQ(json[0]["integrator"], "leapfrog");
  EXPECT_EQ(json.back()["integrator"], "event");
  const auto points = lines_of(test::read_file(directory_ / "out/stability_map_time_step.csv"));
  ASSERT_EQ(points.size(), 1u + 4 * kIntegrators.size());
  EXPECT_EQ(cells_of(points[4])[6], "leapfrog");
  EXPECT_EQ(cells_of(points[5])[6], "velocity_verlet");
  EXPECT_EQ(cells_of(points[5])[5], "");  // the inequality is leapfrog's
}

TEST_F(StabilityExperiments, MapsAreTheSameBytesOnAnyNumberOfThreads) {
  for (const char* jobs : {"1", "3"}) {
    hapbench({"stability", "--map", "contacts", "--algorithms", "tandpasta", "--size", "4", "--jobs", jobs, "--out",
              (directory_ / jobs).string()});
  }
  test::expect_same_files(directory_ / "1", directory_ / "3", {});
}

TEST_F(StabilityExperiments, StressCountsForcesOfEveryAlgorithm) {
  const ProgramRun run = hapbench({"stability", "--stress", "--count", "2000", "--json", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  EXPECT_EQ(json.size(), algorithms().size());
  for (const Json& counts : json) {
    EXPECT_EQ(counts["sets"], 2000);
    EXPECT_EQ(counts["non_finite"], 0);
    EXPECT_EQ(counts["out_of_bound"], 0);
    EXPECT_EQ(counts["first_bad_set"], nullptr);
  }
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/stability_stress.csv")).size(), 1 + algorithms().size());
  // The seed decides.
  const auto text = [&](const char* seed) {
    return hapbench({"stability", "--stress", "--count", "50", "--seed", seed, "--json", "--out", out_}).out;
  };
  EXPECT_EQ(text("5"), text("5"));
  EXPECT_NE(text("5"), text("6"));
}

}  // namespace
}  // namespace hapbench::stability_test
