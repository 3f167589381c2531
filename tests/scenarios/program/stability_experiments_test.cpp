#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// `hapbench stability --map`, `--stress` and `--search` through the program.
namespace hapbench::stability_experiments_test {
namespace {

using test::cells_of;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using Names = std::vector<std::string>;

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
            "passive_abbott_okamura_stiffness_N_per_m,exact_undamped_handle_stiffness_N_per_m,overrides");
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

TEST_F(StabilityExperiments, MapsRefuseOverridesThatAreNotTheirs) {
  const auto refused = [&](const char* map, const char* override, const char* said) {
    const ProgramRun run = hapbench({"stability", "--map", map, "--size", "2", "--set", override, "--out", out_});
    EXPECT_EQ(run.status, 2) << override;
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(out_));
  };
  refused("wedge", "device.handle_mass_kg=1", "for the map \"wedge\"; allowed: for \"z_width\", \"delay\"");
  refused("friction_quantisation", "device.encoder_step_m=1e-5", "for the map \"friction_quantisation\"; allowed: for");
  refused("delay", "device.delay_samples=1", "which delay_samples of the map \"delay\" varies");
  refused("delay", "device=my.json", "\"$(cat my.json)\" is what is in the file");
  refused("hand", "hand.stiffness_N_per_m=1", "which hand_stiffness_N_per_m of the map");
  refused("z_width", "rendering.mass_kg=1", "allowed: time.step_s and fields of device and hand");
  refused("z_width", "time.steps=5", "allowed: time.step_s and");
  refused("z_width", "device.preset=touch", "allowed: device as a whole");
  refused("z_width", "device={\"type\":\"ideal\"}", "allowed: \"impedance\"");
  refused("z_width", "device.handle_mas_kg=1", "map z_width: /device/handle_mas_kg: unknown field; allowed here: ");
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
  ASSERT_EQ(json.size(), 5u);
  EXPECT_EQ(json[0]["integrator"], "leapfrog");
  EXPECT_EQ(json[4]["integrator"], "implicit_midpoint");
  const auto points = lines_of(test::read_file(directory_ / "out/stability_map_time_step.csv"));
  ASSERT_EQ(points.size(), 1u + 5 * 4);
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

TEST_F(StabilityExperiments, SearchWritesAScenarioThatRunsAsItExpects) {
  const ProgramRun run = hapbench({"stability", "peg_in_hole_2d_shaped_stiffness", "--search", "--algorithms",
                                   "original_averaging,mean", "--evaluations", "40", "--out", out_});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(test::names_below(out_), (Names{"worst_created_mean.json", "worst_created_original_averaging.json"}));
  for (const std::string& name : test::names_below(out_)) {
    const ProgramRun again = hapbench({"run", out_ + "/" + name, "--out", (directory_ / "again").string()});
    EXPECT_EQ(again.status, 0) << name << ": " << again.err;
  }
  EXPECT_EQ(hapbench({"stability", "peg_in_hole_2d_mean", "--search", "--objective", "vibration", "--evaluations", "20",
                      "--json", "--out", out_})
                .json()[0]["objective"],
            "vibration");
}

TEST_F(StabilityExperiments, WrongUseIsRefusedAndNothingWritten) {
  const std::vector<Names> wrong = {
      {"--map"},
      {"--map", "no_such_map"},
      {"--map", "wedge,wedge"},
      {"--map", "wedge,all"},
      {"--map", "wedge", "--size", "1"},
      {"--map", "wedge", "--size", "1000"},
      {"--map", "wedge", "--size", "x"},
      {"--map", "wedge", "--jobs", "0"},
      {"--map", "wedge", "--algorithms", "no_such_law"},
      {"--map", "wedge", "--algorithms", "mean,mean"},
      {"--map", "wedge", "--set", "time.steps=5"},
      {"--map", "wedge", "--integrators", "no_such_integrator"},
      {"--map", "wedge", "--integrators", "rk4,rk4"},
      {"--map", "wedge", "--integrators", "rk4,all"},
      {"single_spring", "--integrators", "rk4"},
      {"--map", "wedge", "--stress"},
      {"--map", "wedge", "--search"},
      {"--map", "wedge", "--count", "5"},
      {"single_spring", "--map", "wedge"},
      {"single_spring", "--stress"},
      {"single_spring", "--size", "5"},
      {"single_spring", "--algorithms", "mean"},
      {"--stress", "--count", "0"},
      {"--stress", "--count", "-1"},
      {"--stress", "--seed", "-1"},
      {"--stress", "--algorithms", "mean"},
      {"--stress", "--search"},
      {"--search"},
      {"single_spring", "--search"},
      {"no_such_scenario", "--search"},
      {"peg_in_hole_2d_mean", "single_spring", "--search"},
      {"peg_in_hole_2d_mean", "--search", "--objective", "beauty"},
      {"peg_in_hole_2d_mean", "--search", "--evaluations", "0"},
      {"peg_in_hole_2d_mean", "--objective", "created"},
  };
  for (Names arguments : wrong) {
    std::string words;
    for (const std::string& word : arguments) words += word + " ";
    arguments.insert(arguments.begin(), "stability");
    arguments.insert(arguments.end(), {"--out", out_});
    const ProgramRun run = hapbench(arguments);
    EXPECT_EQ(run.status, 2) << words;
    EXPECT_EQ(run.out, "") << words;
    EXPECT_NE(run.err, "") << words;
    EXPECT_FALSE(std::filesystem::exists(out_)) << words;
  }
}

TEST_F(StabilityExperiments, MisspeltMapsGetTheNearestName) {
  const ProgramRun run = hapbench({"stability", "--map", "wegde", "--out", out_});
  EXPECT_EQ(lines_of(run.err).size(), 1u) << run.err;
  EXPECT_NE(run.err.find("nearest valid name: \"wedge\""), std::string::npos) << run.err;
}

TEST_F(StabilityExperiments, AreExplained) {
  const ProgramRun run = hapbench({"describe", "stability"});
  EXPECT_EQ(run.status, 0);
  for (const char* word :
       {"vibrating", "analytic limit", "damping_ratio", "delay_samples", "stable_gil_hulin", "Colgate"}) {
    EXPECT_NE(run.out.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace hapbench::stability_experiments_test
