#include <gtest/gtest.h>

#include "device_model/device_presets.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/program.hpp"

/// `compare --devices`: the largest stiffness that devices render.
namespace hapbench::compare_devices_test {
namespace {

using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using Words = std::vector<std::string>;

class CompareDevices : public testing::Test {
 protected:
  CompareDevices() {
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
  ProgramRun compare(const std::string& devices, const std::string& out, const Words& more = {}) const {
    Words words = {"compare", file("press.json"), "--devices", devices, "--out", file(out)};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  test::TemporaryDirectory directory_;
};

TEST_F(CompareDevices, AnswersAsLimitDoes) {
  const Words question = {"--algorithms", "shaped_stiffness,summation", "--vibration", "0.002", "--resolution", "0.01",
                          "--json"};
  const ProgramRun table = compare("omega.3", "out", question);
  ASSERT_EQ(table.status, 0) << table.err;
  Words words = {"limit", file("press.json"), "--vary", "rendering.stiffness_N_per_m", "--out", file("limit")};
  words.insert(words.end(), question.begin(), question.end());
  const Json limits = hapbench(words).json()["limits"], rows = table.json()["limits"];
  ASSERT_EQ(rows.size(), 2u);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_TRUE(rows[i]["limit_N_per_m"].is_number());
    EXPECT_EQ(rows[i]["limit_N_per_m"], limits[i]["limit"]);
    EXPECT_EQ(rows[i]["beyond_N_per_m"], limits[i]["beyond"]);
    EXPECT_EQ(rows[i]["runs"], limits[i]["runs"]);
    EXPECT_LE(rows[i]["vibration_m_per_s"], 0.002);
    EXPECT_EQ(rows[i]["published_N_per_m"], 5000.0);
  }
}

TEST_F(CompareDevices, SummationRendersOneOverTheContactsOfAFlatWall) {
  const Json rows = compare("touch", "out", {"--json"}).json()["limits"];
  const Json &shaped = rows[0], &summation = rows[1];
  EXPECT_EQ(shaped["stiffness_ratio"], 1.0);
  EXPECT_NEAR(shaped["lambda_max"].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(summation["contacts"].get<double>(), 49.0, 1e-9);
  EXPECT_NEAR(summation["lambda_max"].get<double>(), 49.0, 1e-9);
  // Equal normals make one spring of n K: both searches end within their 1 % of the same stiffness.
  EXPECT_NEAR(summation["rendered_ratio"].get<double>(), 1.0, 0.021);
  EXPECT_NEAR(summation["stiffness_ratio"].get<double>(), 1.0 / 49.0, 0.021 / 49.0);
}

TEST_F(CompareDevices, GivesTheSameBytesWhateverTheJobs) {
  const ProgramRun one = compare("ideal,admittance,touch", "one", {"--jobs", "1"});
  const ProgramRun two = compare("ideal,admittance,touch", "two", {"--jobs", "2"});
  EXPECT_EQ(one.status, 0) << one.err;
  test::expect_same_files(directory_ / "one", directory_ / "two");
  EXPECT_EQ(test::names_below(directory_ / "one"), (Words{"device_limits.csv", "device_runs.csv"}));
  EXPECT_EQ(lines_of(test::read_file(directory_ / "one/device_limits.csv")).size(), 1u + 3 * 2);
  for (const char* text :
       {"B = 0 at every K", "published", "touch", "0.001 m/s rms above 30 Hz", "summation in press: "}) {
    EXPECT_NE(one.out.find(text), std::string::npos) << text << one.out;
  }
}

TEST_F(CompareDevices, OverridesHoldForEveryDevice) {
  const ProgramRun run =
      compare("ideal,touch", "out",
              {"--set", "rendering.damping_ratio=0.5", "--set", "rendering.mass_kg=0.3", "--set", "hand.mass_kg=0.1"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.out.find("damping_ratio zeta = 0.5 and rendering.mass_kg m = 0.3"), std::string::npos) << run.out;
}

TEST_F(CompareDevices, TakesADeviceOfOnesOwn) {
  // touch, in numbers: the answers have to be the same.
  const std::string device =
      R"({"type": "impedance", "handle_mass_kg": 0.045, "viscous_N_s_per_m": 0.1, "coulomb_N": 0.2,
          "encoder_step_m": 0.055e-3, "force_max_N": 3.3})";
  test::write_plainly(directory_ / "mine.json", device);
  test::write_plainly(directory_ / "scene.json", R"({"extends": "press.json", "device": )" + device + "}");
  const ProgramRun run =
      compare("touch," + file("mine.json") + "," + file("scene.json"), "out", {"--algorithms", "summation", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const Json rows = run.json()["limits"];
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1]["device"], "mine");
  EXPECT_EQ(rows[2]["device"], "scene");
  for (const Json& row : rows) EXPECT_EQ(row["limit_N_per_m"], rows[0]["limit_N_per_m"]);
  EXPECT_EQ(rows[0]["published_N_per_m"], 400.0);
  EXPECT_EQ(rows[1]["published_N_per_m"], nullptr);
}

TEST_F(CompareDevices, MarksAPresetWithOtherNumbers) {
  const Words question = {"--algorithms", "mean", "--resolution", "0.5"};
  const auto with = [&](const char* override) {
    Words words = question;
    words.insert(words.end(), {"--set", override});
    return compare("touch", "out", words);
  };
  const ProgramRun changed = with("device.coulomb_N=0");
  EXPECT_NE(changed.out.find("\ntouch*"), std::string::npos) << changed.out;
  EXPECT_NE(changed.out.find("*: a preset with numbers of --set"), std::string::npos) << changed.out;
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/device_limits.csv"))[1].find("touch*,press,mean,"), 0u);
  EXPECT_EQ(changed.out.find("400"), std::string::npos) << changed.out;
  const ProgramRun delayed = with("device.delay_samples=1");
  EXPECT_NE(delayed.out.find("\ntouch*"), std::string::npos) << delayed.out;
  EXPECT_EQ(with("hand.mass_kg=0.1").out.find("touch*"), std::string::npos);
}

TEST_F(CompareDevices, SaysWhichDelaysDiffer) {
  test::write_plainly(directory_ / "mine.json",
                      R"({"type": "impedance", "handle_mass_kg": 0.1, "delay_samples": 1.5})");
  const Words question = {"--algorithms", "mean", "--resolution", "0.5"};
  const auto out = [&](const std::string& devices) { return compare(devices, "out", question).out; };
  EXPECT_NE(out("touch,ideal," + file("mine.json")).find("\ndelay_samples: 0 of touch; 1.5 of mine; "),
            std::string::npos);
  EXPECT_EQ(out("touch,falcon,ideal").find("delay_samples"), std::string::npos);
}

TEST_F(CompareDevices, TakesAllPresetsByTheirType) {
  const Words question = {"--algorithms", "mean", "--resolution", "0.5", "--set", "device.delay_samples=1", "--json"};
  const Json rows = compare("impedance", "out", question).json()["limits"];
  ASSERT_EQ(rows.size(), device_presets().size());
  EXPECT_EQ(rows[0]["device"], "touch*");
}

TEST_F(CompareDevices, LimitSaysThatAFieldHasNoEffect) {
  const auto limit = [&](const char* field, const char* override) {
    return hapbench({"limit", file("press.json"), "--vary", field, "--set", override, "--resolution", "0.1", "--out",
                     file("limit")})
        .out;
  };
  const char* filter = "device.velocity_filter={\"type\":\"low_pass\",\"cutoff_Hz\":100}";
  const std::string idle = "cutoff_Hz has no effect here: the handle moves alike in all ";
  EXPECT_NE(limit("device.velocity_filter.cutoff_Hz", filter).find(idle), std::string::npos);
  EXPECT_EQ(limit("rendering.stiffness_N_per_m", filter).find("no effect"), std::string::npos);
}

TEST_F(CompareDevices, RefusesBadInput) {
  const auto refused = [&](const Words& words, const std::string& said) {
    const ProgramRun run = hapbench(words);
    EXPECT_EQ(run.status, 2);
    EXPECT_NE(run.err.find(said), std::string::npos) << run.err;
    EXPECT_FALSE(std::filesystem::exists(directory_ / "bad"));
  };
  const std::string scene = file("press.json"), out = file("bad");
  refused({"compare", scene, "--devices", "omega3", "--out", out}, "nearest valid name: \"omega.3\"");
  refused({"compare", scene, "--devices", "all,touch", "--out", out}, "--devices: got \"all\" beside other names");
  refused({"compare", scene, "--devices", "touch", "--vibration", "0", "--out", out}, "--vibration: got \"0\"");
  refused({"compare", scene, "--devices", "touch", "--seeds", "2", "--out", out}, "--devices excludes --seeds");
  refused({"compare", scene, "--vibration", "1", "--out", out}, "--vibration requires --devices");
  refused({"compare", scene, scene, "--devices", "touch", "--out", out}, "a second scenario named \"press\"");
  refused({"compare", scene, "--devices", "touch", "--set", "time.step_s=0.02", "--out", out},
          "/time/step_s: got 0.02; allowed for --vibration");
  refused({"compare", scene, "--devices", "touch,ideal", "--set", "device.delay_samples=1", "--out", out},
          "--devices ideal: " + scene +
              ": /device/delay_samples: unknown field; allowed here: \"type\", "
              "\"force_limit_N\"; only an object of another type has it; \"--devices impedance\" leaves this one out");
  refused({"compare", "--out", out}, "compare: scenarios is required");
  refused({"compare", scene, "--devices", "touch", "--set", "device.preset=falcon", "--out", out},
          "--set: got device.preset with --devices; allowed: fields of the devices");
  const auto refuses_file = [&](const char* name, const char* text, const char* said) {
    test::write_plainly(directory_ / name, text);
    refused({"compare", scene, "--devices", file(name) + ",touch", "--out", out}, said);
  };
  refuses_file("a.json", R"({"type": "impedance", "handle_mas_kg": 0.1})",
               "a.json: /handle_mas_kg: unknown field; allowed here: ");
  refuses_file("a.json", R"({"time": {"step_s": 0.001}})", "a.json: got no device; allowed: ");
  refuses_file("a.json", R"({"extends": "press.json", "device": {"type": "impedance", "handle_mass_kg": 0}})",
               "a.json: /device/handle_mass_kg: got 0");
  refuses_file("touch.json", R"({"type": "ideal"})", "--devices: got a second device named \"touch\"");
  refused({"compare", scene, "--devices", file("none.json"), "--out", out}, "none.json: ");
}

}  // namespace
}  // namespace hapbench::compare_devices_test
