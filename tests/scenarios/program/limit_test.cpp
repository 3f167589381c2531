#include <gtest/gtest.h>

#include <map>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// hapbench limit: on devices, and over the values of other fields.
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
    for (const char* same : {"limit", "beyond", "runs", "class_beyond"}) EXPECT_EQ(rows[i][same], own[i][same]) << same;
    EXPECT_LE(rows[i]["vibration_m_per_s"], 0.002);
    EXPECT_EQ(rows[i]["published_N_per_m"], 5000.0);
    // Under the former name, too, for programs that read it.
    EXPECT_EQ(rows[i].at("astray"), rows[i].at("inconsistent_runs"));
  }
  for (const char* name : {"out/limit.csv", "own/limit.csv"})
    EXPECT_TRUE(lines_of(test::read_file(directory_ / name))[0].ends_with(",runs,inconsistent_runs,astray")) << name;
}

TEST_F(LimitCommand, ComparesLawsByWhatTheHandMeets) {
  const Json rows = ask({"--device", "touch", "--friction", "none", "--algorithms", "shaped_stiffness,summation",
                         "--resolution", "0.01", "--json"})
                        .json()["limits"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0]["lambda_max"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(rows[1]["lambda_max"].get<double>(), 49.0, 1e-9);
  EXPECT_NEAR(rows[1]["contacts"].get<double>(), 49.0, 1e-9);
  // Equal normals make one spring of n K: both searches end within their 1 % of the same stiffness.
  EXPECT_NEAR(rows[1]["rendered_ratio"].get<double>(), 1.0, 0.021);
  EXPECT_NEAR(rows[1]["stiffness_ratio"].get<double>(), 1.0 / 49.0, 0.021 / 49.0);
}

TEST_F(LimitCommand, GivesTheSameBytesWhateverTheJobs) {
  const ProgramRun one = on("ideal,admittance,touch", {"--jobs", "1"}, "one");
  on("ideal,admittance,touch", {"--jobs", "2"}, "two");
  EXPECT_EQ(one.status, 0) << one.err;
  test::expect_same_files(directory_ / "one", directory_ / "two");
  EXPECT_EQ(lines_of(test::read_file(directory_ / "one/limit.csv")).size(), 1u + 3 + 2) << "both ends of a touch";
  for (const char* text : {"B = 0 at every K", "published", "touch[soft]", "0.001 m/s rms above 30 Hz"})
    EXPECT_NE(one.out.find(text), std::string::npos) << text << one.out;
}

TEST_F(LimitCommand, OverridesHoldForEveryDevice) {
  const ProgramRun run = on("ideal,touch", {"--set", "rendering.damping_ratio=0.5", "--set", "rendering.mass_kg=0.3",
                                            "--set", "hand.mass_kg=0.1"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("damping_ratio zeta = 0.5 and rendering.mass_kg m = 0.3"), std::string::npos) << run.out;
}

TEST_F(LimitCommand, TakesADeviceOfOnesOwn) {
  // touch, in numbers: the answers have to be the same.
  const std::string device =
      R"({"type": "impedance", "handle_mass_kg": 0.045, "viscous_N_s_per_m": 0.1, "coulomb_N": 0.2,
          "encoder_step_m": 0.055e-3, "force_max_N": 3.3})";
  test::write_plainly(directory_ / "mine.json", device);
  test::write_plainly(directory_ / "scene.json", R"({"extends": "press.json", "device": )" + device + "}");
  const Json rows =
      on("touch," + file("mine.json") + "," + file("scene.json"), {"--friction", "none", "--json"}).json()["limits"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1]["device"], "mine");
  EXPECT_EQ(rows[2]["device"], "scene");
  for (const Json& row : rows) EXPECT_EQ(row["limit"], rows[0]["limit"]);
  EXPECT_EQ(rows[0]["published_N_per_m"], 400.0);
  EXPECT_EQ(rows[1]["published_N_per_m"], nullptr);
}

TEST_F(LimitCommand, MarksAPresetWithOtherNumbers) {
  const ProgramRun changed = on("touch", {"--set", "device.coulomb_N=0"});
  EXPECT_NE(changed.out.find("\ntouch* "), std::string::npos) << changed.out;
  EXPECT_NE(changed.out.find("*: a preset with numbers of --set"), std::string::npos) << changed.out;
  EXPECT_EQ(changed.out.find("400"), std::string::npos) << changed.out;
  EXPECT_EQ(on("touch", {"--set", "hand.mass_kg=0.1"}).out.find("touch*"), std::string::npos);
  EXPECT_NE(on("impedance", {"--set", "device.delay_samples=1"}).out.find("\nlambda.7*[stiff]"), std::string::npos);
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

TEST_F(LimitCommand, SaysWhichDelaysDiffer) {
  test::write_plainly(directory_ / "mine.json",
                      R"({"type": "impedance", "handle_mass_kg": 0.1, "delay_samples": 1.5})");
  EXPECT_NE(on("touch,ideal," + file("mine.json"))
                .out.find("\ndelay_samples: 0 of touch; 1.5 (1.5 ms in steps of 1 ms) of mine"),
            std::string::npos);
  EXPECT_EQ(on("touch,falcon,ideal").out.find("delay_samples"), std::string::npos);
}

TEST_F(LimitCommand, SaysThatAFieldHasNoEffect) {
  const auto said = [&](const char* field) {
    return ask({"--vary", field, "--set", R"(device.velocity_filter={"type":"low_pass","cutoff_Hz":100})",
                "--resolution", "0.1"})
        .out;
  };
  const std::string idle = "cutoff_Hz has no effect here: the handle moves alike in all ";
  EXPECT_NE(said("device.velocity_filter.cutoff_Hz").find(idle), std::string::npos);
  EXPECT_EQ(said("rendering.stiffness_N_per_m").find("no effect"), std::string::npos);
}

}  // namespace
}  // namespace hapbench::limit_test
