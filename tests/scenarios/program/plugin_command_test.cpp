#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

/// Tests the program with external laws.
namespace hapbench::plugin_command_test {
namespace {

namespace fs = std::filesystem;
using test::EnvironmentVariable;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using test::read_file;
using Words = std::vector<std::string>;

std::string plugin(const std::string& name) {
  return (fs::path(HAPBENCH_TEST_MODULES) / (name + ".so")).string();
}

class PluginCommand : public testing::Test {
 protected:
  std::string out(const std::string& name) const { return (directory_ / name).string(); }
  Json summary(const std::string& folder) const {
    return Json::parse(read_file(directory_ / (folder + "/summary.json")));
  }
  test::TemporaryDirectory directory_;
};

TEST_F(PluginCommand, KnowsTheLawAndItsParametersEverywhere) {
  // The option may stand before or after the command.
  const ProgramRun described = hapbench({"--module", plugin("depth_weighted"), "describe", "depth_weighted"});
  EXPECT_EQ(described.status, 0) << described.err;
  EXPECT_NE(described.out.find("depth_weighted.so, hash "), std::string::npos);
  EXPECT_NE(described.out.find("rendering.parameters.depth_weighted.power ["), std::string::npos) << described.out;
  const ProgramRun list = hapbench(
      {"describe", "algorithms", "--module", plugin("depth_weighted"), "--module", plugin("capped_summation")});
  EXPECT_NE(list.out.find("capped_summation"), std::string::npos) << list.err;
  EXPECT_NE(list.out.find("depth_weighted"), std::string::npos);
  EXPECT_EQ(hapbench({"describe", "algorithms"}).out.find("depth_weighted"), std::string::npos);
  const EnvironmentVariable folders("HAPBENCH_MODULE_PATH", out("plugins"));
  fs::create_directory(out("plugins"));
  fs::copy_file(plugin("depth_weighted"), out("plugins/my.so"));
  EXPECT_NE(hapbench({"describe", "algorithms"}).out.find("depth_weighted"), std::string::npos);
}

TEST_F(PluginCommand, ComparesTheLawsWithOurs) {
  const ProgramRun run =
      hapbench({"compare", "peg_in_hole_2d_shaped_stiffness", "--module", plugin("depth_weighted"), "--module",
                plugin("capped_summation"), "--algorithms", "mean,depth_weighted,capped_summation", "--set",
                "rendering.parameters.depth_weighted.power=0", "--out", out("a"), "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  ASSERT_EQ(json.size(), 3u);
  // With power 0 the law equals the mean to the last bit.
  EXPECT_EQ(json[1]["state_hash"], json[0]["state_hash"]);
  EXPECT_LE(json[2]["metrics"]["ratio_max"].get<double>(), 1.0 + 1e-12);
  EXPECT_FALSE(summary("a/mean")["provenance"].contains("plugin"));
  const Json provenance = summary("a/depth_weighted")["provenance"];
  EXPECT_EQ(provenance["plugin"]["file"], "depth_weighted.so");
  EXPECT_EQ(provenance["plugin"]["hash"].get<std::string>().size(), 16u);
}

TEST_F(PluginCommand, EndsARunAndNoMoreWhenALawFails) {
  const EnvironmentVariable how("HOSTILE", "error");
  const ProgramRun run = hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--module", plugin("hostile"), "--set",
                                   "rendering.algorithm=hostile", "--out", out("run")});
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(
      run.err.find("outcome is \"diverges\" (hostile (hostile.so) fails in step: the oven? is ? cold, at step 0)"),
      std::string::npos)
      << run.err;
  EXPECT_EQ(summary("run")["divergence"]["fault"], "hostile (hostile.so) fails in step: the oven? is ? cold");

  const ProgramRun both = hapbench({"compare", "peg_in_hole_2d_shaped_stiffness", "--module", plugin("hostile"),
                                    "--algorithms", "hostile,mean", "--out", out("compare"), "--json"});
  EXPECT_EQ(both.status, 3);
  EXPECT_EQ(both.json()[0]["outcome"], "diverges");
  EXPECT_EQ(both.json()[1]["outcome"], "leaves_hole");
  EXPECT_NE(both.err.find("hostile diverges at step 0: hostile (hostile.so) fails in step"), std::string::npos)
      << both.err;
}

TEST_F(PluginCommand, EndsARunWhenALawWritesAFaultAndReturnsZero) {
  const EnvironmentVariable how("HOSTILE", "error without status");
  const ProgramRun run = hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--module", plugin("hostile"), "--set",
                                   "rendering.algorithm=hostile", "--out", out("run")});
  EXPECT_EQ(run.status, 3);
  EXPECT_EQ(summary("run")["divergence"]["fault"], "hostile (hostile.so) fails in step: the oven? is ? cold");
}

/// Checks that the command fails even if the scenario expects a run that diverges.
TEST_F(PluginCommand, FailsWhenASourceOfContactsFails) {
  const EnvironmentVariable how("HOSTILE", "contacts");
  const std::string source =
      R"(rendering.contact_source={"type":"plugin","file":")" + fs::canonical(plugin("hostile")).string() + "\"}";
  std::vector<std::string> command = {
      "run", "plane_wiped_round", "--set", source, "--set", "expect={\"outcome\":\"diverges\"}", "--out", out("run")};
  for (const char* name : {"run", "validate", "sweep", "compare", "converge", "tune", "limit"}) {
    const ProgramRun refused = hapbench({name, "plane_wiped_round", "--set", source});
    EXPECT_EQ(refused.status, 2) << name;
    const bool names_file = refused.err.find("allowed: with --module ") != std::string::npos;
    // Two commands stop before they read the library: `sweep` because it gets no --vary, and `limit` because the tool
    // is on a prescribed path.
    const bool refuses_before = name == std::string("sweep") || name == std::string("limit");
    EXPECT_TRUE(names_file || refuses_before) << name << refused.err;
  }
  command.push_back("--allow-modules");
  const ProgramRun run = hapbench(command);
  EXPECT_EQ(run.status, 3);
  EXPECT_NE(run.err.find("hostile (hostile.so) gives 10001 contacts; allowed: at most 10000"), std::string::npos)
      << run.err;
  EXPECT_NE(run.err.find("a law or contact source of a module failed once"), std::string::npos) << run.err;
}

/// Checks the proxy, which finds its contacts itself. The contacts of a module change neither its force nor its
/// metrics, and `compare` warns that the proxy does not use them.
TEST_F(PluginCommand, LeavesContactsOfAModuleOutWhereTheLawFindsItsOwn) {
  const std::string sphere =
      R"(rendering.contact_source={"type":"plugin","file":")" + plugin("sphere") + R"(","config":{"radius_m":0.002}})";
  const Words words = {"compare", "plane_wiped_round", "--algorithms", "mean,proxy", "--json"};
  const auto compare = [&](Words more, const std::string& folder) {
    more.insert(more.begin(), words.begin(), words.end());
    more.insert(more.end(), {"--out", out(folder)});
    return hapbench(more);
  };
  const ProgramRun with = compare({"--allow-modules", "--set", sphere}, "with"), without = compare({}, "without");
  EXPECT_NE(with.err.find("algorithm \"proxy\" finds its contacts itself"), std::string::npos) << with.err;
  EXPECT_EQ(without.err.find("finds its contacts itself"), std::string::npos) << without.err;
  EXPECT_EQ(with.json()[1]["metrics"], without.json()[1]["metrics"]);
  EXPECT_NE(with.json()[0]["metrics"], without.json()[0]["metrics"]);
}

TEST_F(PluginCommand, FailsWhenALawEndsTheProgram) {
  const EnvironmentVariable how("HOSTILE", "exits");
  const ProgramRun run = hapbench({"run", "single_spring", "--module", plugin("hostile"), "--set",
                                   "rendering.algorithm=hostile", "--out", out("run")});
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, "hapbench: error: internal fault: a module or a library called exit\n");
}

TEST_F(PluginCommand, IsStoppedInALawThatDoesNotReturn) {
  const EnvironmentVariable how("HOSTILE", "loops");
  test::RunningProgram run(test::hapbench_program(), {"run", "single_spring", "--module", plugin("hostile"), "--set",
                                                      "rendering.algorithm=hostile", "--out", out("run")});
  ASSERT_TRUE(run.runs_until([&] { return run.err() == "looping\n"; })) << run.err();
  const auto sent = std::chrono::steady_clock::now();
  EXPECT_EQ(run.end_by(SIGINT), -SIGINT);
  EXPECT_LT(std::chrono::steady_clock::now() - sent, std::chrono::seconds(5)) << "the machine may be busy";
  EXPECT_EQ(run.err(), "looping\nhapbench: ended amid work that did not notice the signal for two seconds\n");
}

TEST_F(PluginCommand, FindsWhatIsNoForceBehindEveryStage) {
  for (const char* fault : {"nan", "forgets", "not created"}) {
    const EnvironmentVariable how("HOSTILE", fault);
    for (const char* stage :
         {"rendering.passivity_controller=true", "rendering.limits.max_force_N=1", "rendering.angular_damping=true",
          "integrator.type=rk4", "integrator.type=implicit_midpoint"}) {
      const ProgramRun run = hapbench({"run", "peg_in_hole_2d_shaped_stiffness", "--module", plugin("hostile"), "--set",
                                       "rendering.algorithm=hostile", "--set", stage, "--out", out("run")});
      EXPECT_EQ(run.status, 3) << fault << stage;
      EXPECT_NE(run.err.find("outcome is \"diverges\" (hostile "), std::string::npos) << stage << run.err;
    }
  }
}

TEST_F(PluginCommand, SweepsCarryThePluginAlong) {
  const fs::path mine = directory_ / "mine.so";
  fs::copy_file(plugin("depth_weighted"), mine);
  Words words = {"sweep",    "single_spring",
                 "--module", mine.string(),
                 "--set",    "rendering.algorithm=depth_weighted",
                 "--vary",   "rendering.parameters.depth_weighted.power=0,1,2",
                 "--out",    out("s")};
  const auto with = [&words](Words more) {
    more.insert(more.begin(), words.begin(), words.end());
    return hapbench(more);
  };
  const ProgramRun print = with({"--row", "2", "--print"});
  EXPECT_NE(print.out.find("--module " + mine.string()), std::string::npos) << print.out;
  ASSERT_EQ(with({"--shard", "0/2"}).status, 0);
  const Json description = Json::parse(read_file(directory_ / "s/sweep.0_of_2.json"));
  EXPECT_EQ(description["plugins"].size(), 1u);
  // The same law in a file with other bytes defines another sweep.
  fs::remove(mine);
  fs::copy_file(plugin("depth_weighted"), mine);
  fs::resize_file(mine, fs::file_size(mine) + 1);
  ASSERT_EQ(with({"--shard", "1/2"}).status, 0);
  EXPECT_NE(hapbench({"sweep", out("s")}).err.find("is of another sweep"), std::string::npos);
}

TEST_F(PluginCommand, RefusesFoldersInOneLine) {
  const EnvironmentVariable folders("HAPBENCH_MODULE_PATH", "/no/such/folder");
  const ProgramRun run = hapbench({"describe"});
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err, "hapbench: error: HAPBENCH_MODULE_PATH: /no/such/folder: No such file or directory\n");
  EXPECT_EQ(hapbench({"--help"}).status, 0);
}

}  // namespace
}  // namespace hapbench::plugin_command_test
