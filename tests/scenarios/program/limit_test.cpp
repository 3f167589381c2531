#include <gtest/gtest.h>

#include <map>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench limit on devices. What it prints of them is in tests/data/golden/studies.txt.
namespace hapbench::limit_test {
namespace {

using Words = std::vector<std::string>;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;

class LimitCommand : public testing::Test {
 protected:
  LimitCommand() {
    // A probe pressed on a plane of 49 points by a hand with a mass.
    test::write_plainly(directory_ / "press.json",
                        R"({"time": {"step_s": 0.001, "steps": 200}, "tool": {"diameter_m": 0.01, "length_m": 0.1},
                            "environment": {"type": "plane", "size_m": 0.006, "spacing_m": 0.001},
                            "hand": {"type": "mass_spring_damper", "mass_kg": 0.2, "stiffness_N_per_m": 300,
                                     "damping_N_s_per_m": 6, "target": {"x_m": 0, "y_m": 0, "z_m": -0.003}},
                            "device": {"type": "impedance", "preset": "omega.3"},
                            "rendering": {"stiffness_N_per_m": 2000, "damping_ratio": 0,
                                          "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0}}})");
  }
  std::string file(const std::string& name) const { return (directory_ / name).string(); }
  ProgramRun ask(Words words, const std::string& out = "out") const {
    words.insert(words.begin(), {"limit", file("press.json"), "--out", file(out)});
    return hapbench(words);
  }
  ProgramRun on(const std::string& devices, Words words = {}, const std::string& out = "out") const {
    words.insert(words.end(), {"--device", devices, "--resolution", "0.5"});
    return ask(words, out);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(LimitCommand, OnADeviceIsThatOfTheSceneWithIt) {
  const Words question = {"--algorithms", "shaped_stiffness,summation", "--vibration", "0.002", "--resolution", "0.01",
                          "--json"};
  Words with_device = question;
  with_device.insert(with_device.end(), {"--device", "omega.3", "--friction", "none"});
  const Json rows = ask(with_device).json()["limits"], own = ask(question, "own").json()["limits"];
  ASSERT_EQ(rows.size(), 2u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_TRUE(rows[i]["limit"].is_number());
    EXPECT_EQ(rows[i]["low"], own[i]["low"]);
    // Asked for alone, the interval is tried between its ends: its edge may be lower, never higher.
    EXPECT_LE(own[i]["limit"], rows[i]["limit"]);
    EXPECT_EQ(own[i]["tried_between"], 48);
    EXPECT_EQ(rows[i]["tried_between"], 0);
    EXPECT_LE(rows[i]["vibration_m_per_s"], 0.002);
    EXPECT_EQ(rows[i]["published_N_per_m"], 5000.0);
    // Under the former name, too, for programs that read it.
    EXPECT_EQ(rows[i].at("astray"), rows[i].at("inconsistent_runs"));
  }
  for (const char* name : {"out/limit.csv", "own/limit.csv"})
    EXPECT_TRUE(lines_of(test::read_file(directory_ / name))[0].ends_with(",runs,inconsistent_runs,astray")) << name;
}

TEST_F(LimitCommand, GivesTheSameBytesWhateverTheJobs) {
  for (const char* jobs : {"1", "2"}) EXPECT_EQ(on("ideal,admittance,touch", {"--jobs", jobs}, jobs).status, 0);
  test::expect_same_files(directory_ / "1", directory_ / "2");
}

/// What is not published of a preset is a device of its own name, with the numbers that --set would give.
TEST_F(LimitCommand, IsAskedAtBothEndsOfWhatIsNotPublished) {
  const auto limits_of = [&](const char* device, Words words) {
    words.emplace_back("--json");
    std::map<std::string, Json> limits;
    const Json rows = on(device, words).json()["limits"];
    for (const Json& row : rows) limits[row["device"]] = row["limit"];
    return limits;
  };
  const auto with = [&](const std::string& coulomb, const std::string& viscous) {
    return limits_of("touch", {"--friction", "none", "--set", "device.coulomb_N=" + coulomb, "--set",
                               "device.viscous_N_s_per_m=" + viscous})
        .at("touch*");
  };
  // Mass and encoder step of a touch are of the data sheet; 0.2 N and 0.1 N s/m are ours.
  const auto both = limits_of("touch", {});
  ASSERT_EQ(both.size(), 3u);
  EXPECT_EQ(both.at("touch[soft]"), with("0", "0.1"));
  EXPECT_EQ(both.at("touch[stiff]"), with("0.4", "1"));
  EXPECT_EQ(limits_of("touch[stiff]", {}).at("touch[stiff]"), both.at("touch[stiff]"));
  const auto friction = limits_of("touch,ideal", {"--friction", "2"});
  ASSERT_EQ(friction.size(), 3u) << "ideal has no friction";
  EXPECT_EQ(friction.at("touch[friction*2]"), with("0.4", "0.1"));
  EXPECT_EQ(on("touch", {"--friction", "2", "--set", "device.coulomb_N=0"}).status, 2);
}

}  // namespace
}  // namespace hapbench::limit_test
