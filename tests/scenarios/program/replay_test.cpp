// Tests `run --replay` and `compare --replay`, which render the log of a haptic loop again with the function that
// rendered it.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "device_model/live/hapbench_renderer.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::replay_test {
namespace {

using test::hapbench;
using test::lines_of;
using test::read_file;
using test::write_plainly;

const char* const kScene = R"({
  "time": {"step_s": 0.001, "steps": 100},
  "environment": {"type": "block_with_hole", "size_m": [0.004, 0.004, 0.004], "hole_diameter_m": 0.0015,
                  "hole_depth_m": 0.003, "grid_m": 0.0002},
  "initial": {"position_m": [0, 0, 0.002]},
  "tool": {"diameter_m": 0.001, "length_m": 0.01, "tip": "round"},
  "device": {"type": "impedance", "handle_mass_kg": 0.05, "velocity_filter": {"type": "low_pass", "cutoff_Hz": 100}},
  "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 2000, "damping_ratio": 0.2},
  "expect": {"outcome": "no_contact"}
})";

/// Returns a log in which the handle moves into the hole, around its wall, out and in again. Two successive calls are
/// 51 ms apart instead of 1 ms. A position that is not a number causes a fault, which is cleared later.
std::string recorded(const std::string& scenario) {
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  mount.max_force = 5.0;
  mount.ramp_s = 0.05;
  Renderer renderer(scenario, mount);
  std::string log = renderer.log_header();
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.001 * i;
    HapbenchInput input{};
    input.time_ns = 5'000'000u + static_cast<std::uint64_t>(i) * 1'000'003u + (i > 1000 ? 50'000'000u : 0u);
    input.handle = {{0.0004 * std::cos(5 * t), 0.0004 * std::sin(5 * t), 0.002 * std::cos(3 * t) - 0.0005},
                    {std::cos(0.05 * t), std::sin(0.05 * t), 0, 0}};
    if (i == 2000) input.handle.position[0] = std::nan("");
    if (i == 2100) input.has = HAPBENCH_REARM;
    log += Renderer::log_row(input, renderer.step(input));
  }
  return log;
}

class Replay : public ::testing::Test {
 protected:
  Replay() {
    write_plainly(folder / "scene.json", kScene);
    write_plainly(folder / "loop.csv", recorded(scene));
  }

  test::TemporaryDirectory folder;
  const std::string scene = folder / "scene.json", log = folder / "loop.csv", out = folder / "out";
};

TEST_F(Replay, HasTheRecordedBitsInBothBuilds) {
  const auto run = hapbench({"run", scene, "--replay", log, "--out", out, "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  EXPECT_EQ(json["calls"], 3000);
  EXPECT_EQ(json["equal_calls"], 3000);
  EXPECT_EQ(json["is_recorded_scenario"], true);
  EXPECT_GT(json["loop_force_max_N"], 0.1);
  EXPECT_GT(json["stale_calls"], 0);
  EXPECT_EQ(json["fault_calls"], 100);
  EXPECT_EQ(read_file(folder / "out/replay.csv"), read_file(log));
  // Check the reference build without SIMD.
  const std::string scalar = folder / "scalar";
  const auto other =
      test::run_program(test::hapbench_scalar_program(), {"run", scene, "--replay", log, "--out", scalar, "--quiet"});
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_EQ(read_file(folder / "scalar/replay.csv"), read_file(log));
}

TEST_F(Replay, ComparesAnotherScenarioAndOtherLaws) {
  const auto run = hapbench({"run", scene, "--replay", log, "--out", out, "--set", "rendering.stiffness_N_per_m=1000"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("recorded with another scenario"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("calls have other outputs than recorded"), std::string::npos) << run.out;
  const auto laws =
      hapbench({"compare", scene, "--replay", log, "--out", out, "--json", "--algorithms", "shaped_stiffness,mean"});
  ASSERT_EQ(laws.status, 0) << laws.err;
  const Json rows = laws.json();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["equal_calls"], 3000);
  EXPECT_LT(rows[1]["equal_calls"], 3000);
  EXPECT_GT(rows[1]["loop_force_difference_max_N"], 0.01);
  EXPECT_EQ(lines_of(read_file(folder / "out/replay_comparison.csv")).size(), 3u);
}

TEST_F(Replay, ReportsALogThatWasEdited) {
  std::vector<std::string> lines = lines_of(read_file(log));
  auto cells = test::cells_of(lines[902]);  // call 900
  ASSERT_EQ(cells[0], "900");
  cells[5] = "0.001";  // the height of the handle
  std::string row;
  for (const std::string& cell : cells) row += (row.empty() ? "" : ",") + cell;
  lines[902] = row;
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  write_plainly(folder / "loop.csv", text);
  const auto run = hapbench({"run", scene, "--replay", log, "--out", out});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("call 900 has other outputs than recorded"), std::string::npos) << run.err;
}

/// Returns a log in which the handle moves from above to `lowest` [m] in 1 s, beside the hole.
std::string pressed(const std::string& scenario, double lowest) {
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  mount.max_force = 5.0;
  Renderer renderer(scenario, mount);
  std::string log = renderer.log_header();
  for (int i = 0; i <= 1000; ++i) {
    HapbenchInput input{};
    input.time_ns = static_cast<std::uint64_t>(i) * 1'000'000u;
    const double height = 0.002 + (lowest - 0.002) * 1e-3 * i;
    input.handle = {{0.001375, 0.0, height}, {1, 0, 0, 0}};
    log += Renderer::log_row(input, renderer.step(input));
  }
  return log;
}

TEST_F(Replay, WarnsOfAToolThatPassedThroughTheSurface) {
  const auto replay = [&](double lowest, const std::string& environment) {
    write_plainly(scene, kScene);
    if (!environment.empty()) write_plainly(scene, environment);
    write_plainly(log, pressed(scene, lowest));
    return hapbench({"run", scene, "--replay", log, "--out", out, "--json"});
  };
  // The top of the block is at z = 0, and the tip centre 0.5 mm above the lowest point of the tool.
  const auto touching = replay(0.0003, "");
  ASSERT_EQ(touching.status, 0) << touching.err;
  EXPECT_GT(touching.json()["loop_force_max_N"], 0.1);
  EXPECT_EQ(touching.json()["went_through"], false);
  EXPECT_EQ(touching.err.find("passed through"), std::string::npos) << touching.err;
  const auto through = replay(-0.002, "");
  EXPECT_EQ(through.json()["went_through"], true);
  // The centre reaches a depth of 0.5 mm after (2 + 0.5) / 4 of the second. The depth has an error of at most 2 %, or
  // 0.01 mm, through which the tool moves in 2.5 ms. A call takes 1 ms.
  const std::string begin = "the tool passed through the surface: at ";
  const auto time = through.err.find(begin);
  ASSERT_NE(time, std::string::npos) << through.err;
  EXPECT_NEAR(std::stod(through.err.substr(time + begin.size())), 0.62675, 0.00175) << through.err;
  EXPECT_NE(through.err.find(" s, its tip centre was deeper below the surface than the half width of the tool, 0.5 mm"),
            std::string::npos)
      << through.err;
  const auto compared = hapbench({"compare", scene, "--replay", log, "--algorithms", "mean,proxy", "--out", out});
  const auto first = compared.err.find("the tool passed through the surface");
  EXPECT_NE(first, std::string::npos) << compared.err;
  EXPECT_EQ(compared.err.find("the tool passed through the surface", first + 1), std::string::npos) << compared.err;
  // Springs have no inside.
  Json springs = Json::parse(kScene);
  springs["environment"] = {{"type", "springs"}, {"groups", {{{"direction", {0, 0, 1}}, {"count", 1}}}}};
  const auto unknown = replay(-0.002, springs.dump());
  EXPECT_TRUE(unknown.json()["went_through"].is_null()) << unknown.err;
}

TEST_F(Replay, AComparisonNamesAnotherScenario) {
  // No warning if only the law differs, also a law that is not compared. A warning if any other field differs.
  const auto warned = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"compare", scene, "--replay", log, "--algorithms", "mean,proxy", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    const auto run = hapbench(words);
    EXPECT_EQ(run.status, 0) << run.err;
    return run.err;
  };
  const std::string other = "the log was recorded with another scenario";
  EXPECT_EQ(warned({}).find(other), std::string::npos);
  EXPECT_EQ(warned({"--set", "rendering.algorithm=summation"}).find(other), std::string::npos);
  EXPECT_NE(warned({"--set", "rendering.stiffness_N_per_m=12345"}).find(other), std::string::npos);
  EXPECT_NE(warned({"--set", "time.step_s=0.0007"}).find("The recorded time step is"), std::string::npos);
  // The same for a log whose law was an override.
  const std::string mean = folder / "mean.csv";
  const LoadedScenario loaded =
      load_scenario(std::filesystem::path(scene), std::vector<std::string>{"rendering.algorithm=mean"});
  std::string text = read_file(log);
  const std::string hash =
      scenario_hash(effective_scenario(loaded.scenario, std::filesystem::current_path()), loaded.files);
  const std::string own = scenario_hash(
      effective_scenario(load_scenario(std::filesystem::path(scene)).scenario, std::filesystem::current_path()), {});
  ASSERT_NE(text.find(own), std::string::npos);
  write_plainly(mean, text.replace(text.find(own), own.size(), hash));
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--set", "rendering.algorithm=summation"}}) {
    std::vector<std::string> words = {"compare", scene, "--replay", mean, "--algorithms", "mean,proxy", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    EXPECT_EQ(hapbench(words).err.find(other), std::string::npos);
  }
}

TEST_F(Replay, RefusesWhatHasNoMeaning) {
  const auto refused = [](const std::vector<std::string>& arguments, const char* words) {
    const auto run = hapbench(arguments);
    EXPECT_EQ(run.status, 2);
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  };
  refused({"run", scene, scene, "--replay", log, "--out", out}, "--replay: got 2 scenarios");
  refused({"run", scene, "--replay", log, "--latency", "--out", out}, "--replay: got it together with");
  refused({"run", scene, "--replay", folder / "none.csv", "--out", out}, "none.csv");
  refused({"run", scene, "--replay", scene, "--out", out}, "is not a log of a haptic loop");
  refused({"compare", scene, "--replay", log, "--errors", "--out", out}, "--replay: got it together with");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Replay, RepeatsTheExampleLoop) {
  const std::filesystem::path example = std::filesystem::path(HAPBENCH_BUILD_DIR) / "bin" / "own_loop";
  if (!std::filesystem::exists(example)) GTEST_SKIP() << "the shared library is not in this build";
  const auto run = test::run_program(example, {"drag_molar", "0.8", log});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("missed deadlines"), std::string::npos) << run.out;
  EXPECT_EQ(lines_of(read_file(log)).size(), 802u);
  const auto replay =
      hapbench({"run", "drag_molar", "--replay", log, "--set", "time.step_s=0.001", "--out", out, "--json"});
  ASSERT_EQ(replay.status, 0) << replay.err;
  EXPECT_EQ(replay.json()["equal_calls"], 800);
  EXPECT_EQ(replay.json()["is_recorded_scenario"], true);
}

}  // namespace
}  // namespace hapbench::replay_test
