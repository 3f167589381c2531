#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/recordings.hpp"
#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::load_scenario_test {
namespace {

namespace fs = std::filesystem;

// "extends" and `--set path=value`. What is refused of files that extend others is in
// tests/data/golden/refused_scenarios.txt.

constexpr const char* kBase = R"({
  "name": "the base", "description": "springs",
  "time": {"step_s": 0.0005, "steps": 20},
  "environment": {"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2}]},
  "hand": {"type": "force", "x_N": {"type": "ramp", "start": 1, "rate_per_s": 2}},
  "rendering": {"reduction": {"threshold": 0.9}, "stiffness_N_per_m": 1000},
  "expect": {"outcome": "diverges"}
})";

class Extends : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((directory_ / name).parent_path());
    test::write_plainly(directory_ / name, text);
    return directory_ / name;
  }
  Json merged(const std::string& text) const {
    write("base.json", kBase);
    return read_scenario_text(write("mine.json", text)).json;
  }

  test::TemporaryDirectory directory_;
};

TEST_F(Extends, MergesObjectsFieldByField) {
  const Json json = merged(R"({"extends": "base.json", "rendering": {"stiffness_N_per_m": 5, "mass_kg": 1},
    "environment": {"bilateral": false}})");
  EXPECT_EQ(json["rendering"],
            Json::parse(R"({"reduction": {"threshold": 0.9}, "stiffness_N_per_m": 5, "mass_kg": 1})"));
  EXPECT_EQ(json["environment"]["type"], "springs");
  EXPECT_EQ(json["environment"]["bilateral"], false);
  EXPECT_EQ(json["time"], Json::parse(kBase)["time"]);
  EXPECT_FALSE(json.contains("extends"));
}

TEST_F(Extends, NullAndListsReplace) {
  const Json json =
      merged(R"({"extends": "base.json", "rendering": {"reduction": null}, "environment": {"groups": []}})");
  ASSERT_TRUE(json["rendering"].contains("reduction"));
  EXPECT_TRUE(json["rendering"]["reduction"].is_null());
  EXPECT_EQ(json["environment"]["groups"], Json::array());
}

TEST_F(Extends, AnObjectOfAnotherTypeReplacesAllOfIt) {
  EXPECT_EQ(merged(R"({"extends": "base.json", "environment": {"type": "plane"}})")["environment"],
            Json::parse(R"({"type": "plane"})"));
  EXPECT_EQ(merged(R"({"extends": "base.json", "hand": {"x_N": {"type": "sine", "mean": 1}}})")["hand"],
            Json::parse(R"({"type": "force", "x_N": {"type": "sine", "mean": 1}})"));
  EXPECT_EQ(merged(R"({"extends": "base.json", "hand": {"type": "force", "y_N": 3}})")["hand"],
            Json::parse(R"({"type": "force", "x_N": {"type": "ramp", "start": 1, "rate_per_s": 2}, "y_N": 3})"));
}

TEST_F(Extends, NeitherNameNorExpectIsTakenOver) {
  merged(R"({"extends": "base.json"})");
  const Scenario scenario = load_scenario(directory_ / "mine.json").scenario;
  EXPECT_EQ(scenario.name, "mine");
  EXPECT_EQ(scenario.description, "springs");
  EXPECT_EQ(scenario.expect.outcomes, Scenario{}.expect.outcomes);
}

TEST_F(Extends, RelativePathsStartFromTheFileThatHasThem) {
  write("there/data/cube.obj", test::read_file(test::data_directory() / "cube.obj"));
  write("there/base.json", R"({"time": {"step_s": 0.0005, "steps": 20},
    "environment": {"type": "mesh", "file": "data/cube.obj", "scale": 0.001}})");
  write("between/middle.json", R"({"extends": "../there/base.json", "seed": 2})");
  const LoadedScenario loaded = load_scenario(write("mine.json", R"({"extends": "between/middle.json", "seed": 3})"));
  EXPECT_EQ(loaded.scenario.seed, 3);
  EXPECT_TRUE(checked(loaded).file_warnings.empty());
  // The effective scenario names it from where it stands, and extends nothing.
  const Json effective = effective_scenario(loaded.scenario, directory_.path());
  EXPECT_EQ(effective["environment"]["file"], "there/data/cube.obj");
  EXPECT_FALSE(effective.contains("extends"));
}

TEST_F(Extends, AnotherTimeStepReplacesTheSamplesOfADelayInSeconds) {
  // As an effective scenario has them: 0.0023 s are 4.6 steps of 0.0005 s.
  write("base.json", R"({"time": {"step_s": 0.0005, "steps": 20}, "environment": {"type": "plane"},
    "device": {"type": "impedance", "handle_mass_kg": 0.1, "delay_s": 0.0023, "delay_samples": 4.6}})");
  const auto samples = [&](const std::string& text) {
    const Scenario scenario = load_scenario(write("mine.json", text)).scenario;
    return std::get<ImpedanceDeviceConfig>(scenario.device).delay_samples;
  };
  EXPECT_EQ(samples(R"({"extends": "base.json"})"), 0.0023 / 0.0005);
  EXPECT_EQ(samples(R"({"extends": "base.json", "time": {"step_s": 0.001}})"), 0.0023 / 0.001);
  // What the file gives itself stays.
  EXPECT_EQ(samples(R"({"extends": "base.json", "time": {"step_s": 0.001}, "device": {"delay_samples": 3}})"), 3.0);
}

TEST_F(Extends, AcceptsItselfInNoJsonInMemory) {
  Json json = Json::parse(kBase);
  json["extends"] = "poke_plane";
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place(), "/extends");
}

constexpr const char* kScenario = R"({
  "name": "base",
  "time": {"step_s": 0.0005, "steps": 20},
  "environment": {"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2}, {"direction": [0, 1, 0], "count": 3}]},
  "rendering": {"reduction": {"threshold": 0.9}}
})";

class Override : public testing::Test {
 protected:
  Override() { test::write_plainly(file_, kScenario); }

  Json with(const std::vector<std::string>& overrides) const {
    return effective_scenario(load_scenario(file_, overrides).scenario, directory_.path());
  }
  /// The refusal, without the file that stands before it.
  std::string refusal(const std::string& override) const {
    SCOPED_TRACE(override);
    const auto error = test::input_error_of([&] { with({override}); });
    if (!error) return "";
    const std::string message = error->what(), before = file_.string() + ": ";
    EXPECT_EQ(message.find(before), 0u) << message;
    return message.substr(before.size());
  }

  test::TemporaryDirectory directory_;
  std::filesystem::path file_ = directory_ / "base scenario.json";
};

TEST_F(Override, SetsWhatItsPathLeadsTo) {
  const struct {
    std::vector<std::string> overrides;
    const char *pointer, *value;
  } kCases[] = {
      {{"time.steps=7"}, "/time/steps", "7"},
      {{"rendering.reduction.threshold=0.5"}, "/rendering/reduction/threshold", "0.5"},
      // Entries of lists, by their index.
      {{"environment.groups.1.count=9"}, "/environment/groups/1/count", "9"},
      {{"environment.groups.1.count=9"}, "/environment/groups/0/count", "2"},
      {{"environment.groups.0.direction.2=4"}, "/environment/groups/0/direction", "[1.0, 0.0, 4.0]"},
      // Objects that are not there are created.
      {{"rendering.limits.max_force_N=30"}, "/rendering/limits/max_force_N", "30.0"},
      {{"record.every=5"}, "/record/every", "5"},
      // JSON of every kind.
      {{"rendering.reduction=null"}, "/rendering/reduction", "null"},
      {{"rendering.local_average=false"}, "/rendering/local_average", "false"},
      {{"initial.position_m=[0.001, 0, -2e-3]"}, "/initial/position_m", "[0.001, 0.0, -0.002]"},
      {{R"(environment={"type":"plane"})"}, "/environment/type", "\"plane\""},
      {{"time.steps=1e3"}, "/time/steps", "1000"},
      // Anything else is a text.
      {{"rendering.algorithm=mean"}, "/rendering/algorithm", "\"mean\""},
      {{R"(rendering.algorithm="mean")"}, "/rendering/algorithm", "\"mean\""},
      {{"description=a = b, c"}, "/description", "\"a = b, c\""},
      {{"description="}, "/description", "\"\""},
      // A later one wins.
      {{"time.steps=7", "time.steps=8"}, "/time/steps", "8"},
      {{R"(rendering={"iterations":9})", "rendering.damping_ratio=0"}, "/rendering/iterations", "9"},
      // The field that says the same is removed.
      {{"time.duration_s=1"}, "/time/steps", "2000"},
      {{"time.duration_s=1", "time.steps=8"}, "/time/steps", "8"},
  };
  for (const auto& c : kCases)
    EXPECT_EQ(with(c.overrides).at(Json::json_pointer(c.pointer)), Json::parse(c.value)) << c.overrides.front();
}

TEST_F(Override, DelayInSecondsIsTheSceneSamples) {
  const std::string device = R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":0.0023})";
  const auto delays = [&](std::vector<std::string> more) {
    more.insert(more.begin(), device);
    const Json json = with(more).at("device");
    return std::pair(json.value("delay_s", -1.0), json.at("delay_samples").get<double>());
  };
  const double step = with({}).at("time").at("step_s").get<double>();
  EXPECT_EQ(delays({}), std::pair(0.0023, 0.0023 / step));
  EXPECT_EQ(delays({"time.step_s=0.001"}), std::pair(0.0023, 0.0023 / 0.001));
  // One replaces the other.
  EXPECT_EQ(delays({"device.delay_samples=3"}), std::pair(-1.0, 3.0));
  EXPECT_EQ(delays({"device.delay_samples=3", "device.delay_s=0.001"}), std::pair(0.001, 0.001 / step));
  // The effective scenario has both and can be read again, also with another step.
  const std::string both = "device=" + with({device}).at("device").dump();
  EXPECT_EQ(with({both}), with({device}));
  EXPECT_EQ(with({both, "time.step_s=0.0003"}), with({device, "time.step_s=0.0003"}));
  EXPECT_EQ(with({both, R"(time={"step_s":0.0003,"steps":20})"}), with({device, "time.step_s=0.0003"}));
  EXPECT_EQ(
      refusal(R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":0.0023,"delay_samples":2.3})")
          .find(
              "/device/delay_s: got 0.0023 s together with delay_samples 2.3; allowed: one of the two, or both where they"),
      0u);
  EXPECT_NE(refusal(R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":-1})").find("/device/delay_s: got -1"),
            std::string::npos);
  EXPECT_EQ(
      refusal(R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":9000})").find("/device/delay_s: got 9000"),
      0u);
}

TEST_F(Override, IsCheckedLikeTheFile) {
  const std::pair<const char*, const char*> kRefusals[] = {
      {"rendering..iterations=1", "/rendering/: unknown field"},
      {".=1", "/: unknown field"},
      {"rendering.mass_kg=heavy", "/rendering/mass_kg: got \"heavy\"; allowed: a number > 0"},
      {"rendering.mass_kg=1e999", "/rendering/mass_kg: got \"1e999\""},
      {"seed.x=1", "/seed: got {\"x\":1}; allowed: an integer"},
      {"time.stop_when.0=leaves_hole", "/time/stop_when: got {"},  // absent: an object is made
      {"environment.groups.2.count=1", "environment.groups.2.count: got list index \"2\"; allowed: 0 ... 1"},
      {"environment.groups.-1=1", "environment.groups.-1: got list index \"-1\"; allowed: 0 ... 1"},
      {"environment.groups.99999999999999999999=1", "environment.groups.99999999999999999999: got list index"},
      {"=5", "--set: got \"=5\"; allowed: path=value, as in rendering.stiffness_N_per_m=40000"},
  };
  for (const auto& [override, message] : kRefusals)
    EXPECT_EQ(refusal(override).find(message), 0u) << override << ": " << refusal(override);
  EXPECT_NE(refusal(R"(rendering={"iterations":1,"iterations":2})").find("stands twice"), std::string::npos);
}

TEST_F(Override, NestedDeeplyIsRefused) {
  std::string path = "rendering";
  for (int i = 0; i < 63; ++i) path += ".a";
  EXPECT_EQ(refusal(path + "=1").find("/rendering/a: unknown field"), 0u);
  EXPECT_EQ(refusal(path + ".a=1").find("--set: got a path of more than 64 keys"), 0u);
  EXPECT_NE(refusal("rendering=" + std::string(20'000, '[') + std::string(20'000, ']')).find("nested too deeply"),
            std::string::npos);
}

/// The warnings about a bundled scenario with these overrides, without the file in front.
std::vector<std::string> warnings_with(std::vector<std::string> overrides) {
  std::vector<std::string> warnings;
  for (const Warning& warning : load_scenario(find_scenario("poke_plane"), overrides).warnings)
    warnings.push_back(warning.told());
  return warnings;
}

TEST(Warnings, NameFieldsThatTheAlgorithmDoesNotRead) {
  EXPECT_TRUE(warnings_with({"rendering.iterations=3"}).empty()) << "the default";
  EXPECT_TRUE(warnings_with({"rendering.iterations=7"}).empty()) << "shaped_stiffness reads it";
  const auto found =
      warnings_with({"rendering.algorithm=mean", "rendering.iterations=7", "rendering.virtual_coupling_N_per_m=100",
                     "rendering.angular_velocity_cutoff_Hz=5"});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_TRUE(found[0].starts_with("/rendering/iterations: has no effect on this algorithm")) << found[0];
  EXPECT_TRUE(found[1].ends_with("it is a parameter of virtual_coupling, static_coupling")) << found[1];
  EXPECT_EQ(found[2], "/rendering/angular_velocity_cutoff_Hz: has no effect without rendering.angular_damping");
}

class NamedFilesOfAScenario : public testing::Test {
 protected:
  NamedFilesOfAScenario() {
    for (const char* name : {"cube.obj", "shell.csv", "stroke.csv"})
      test::write_plainly(directory_ / name, test::read_file(test::data_directory() / name));
  }
  LoadedScenario load(const char* environment, const char* patch = "{}") const {
    Json json = test::minimal_scenario(environment);
    json.merge_patch(Json::parse(patch));
    return read_scenario(json, directory_.path());
  }

  test::TemporaryDirectory directory_;
};

constexpr const char* kStroke = R"({"motion": {"position": {"type": "file", "file": "stroke.csv"}}})";

TEST_F(NamedFilesOfAScenario, AreThoseItNames) {
  const NamedFiles none = load("plane").files;
  EXPECT_TRUE(none.all().empty());
  const NamedFiles both = load("point_shell", kStroke).files;
  ASSERT_EQ(both.all().size(), 2u);
  ASSERT_NE(both.find(kEnvironmentFile), nullptr);
  ASSERT_NE(both.find(kMotionFile), nullptr);
  EXPECT_EQ(both.find(kToolFile), nullptr);
  EXPECT_EQ(both.at(kEnvironmentFile).path(), directory_ / "shell.csv");
  for (const auto& file : both.all()) EXPECT_EQ(file->hash(), hash_text(hash_of(test::read_file(file->path()))));
}

// Whoever changes a file while a run is under way changes neither the run nor what it says of itself.
TEST_F(NamedFilesOfAScenario, AreReadOnce) {
  for (const char* environment : {"mesh", "point_shell"}) {
    const LoadedScenario loaded = checked(load(environment, kStroke));
    const Result report = run_scenario(loaded, directory_ / "out", false);
    for (const char* name : {"cube.obj", "shell.csv", "stroke.csv"})
      fs::rename(directory_ / name, directory_ / (std::string(name) + ".gone"));
    const Result again = run_scenario(loaded, directory_ / "again", false);
    EXPECT_EQ(again.state_hash, report.state_hash);
    EXPECT_EQ(again.scenario_hash, report.scenario_hash);
    EXPECT_THROW(run_scenario(load(environment, kStroke), {}, false), InputError);
    for (const char* name : {"cube.obj", "shell.csv", "stroke.csv"})
      fs::rename(directory_ / (std::string(name) + ".gone"), directory_ / name);
  }
}

// Laws side by side share the parsed mesh, the shell and the inside; a scale of its own keeps other tests' values away.
TEST_F(NamedFilesOfAScenario, AreParsedOnceForAllLaws) {
  const std::size_t before = shared_cache().made();
  for (const AlgorithmEntry& algorithm : algorithms()) {
    Json patch = {{"environment", {{"scale", 0.00123}}}, {"rendering", {{"algorithm", algorithm.info->name}}}};
    run_scenario(checked(load("mesh", patch.dump().c_str())), {}, false);
  }
  EXPECT_EQ(shared_cache().made() - before, 3u);
}

// Refusals of recorded motions are in tests/data/golden/refused_files.txt.

const std::string kHeader = "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z\n";

const std::string kQuaternions = "time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n";

constexpr const char* kFile = "stroke.csv";

RecordedMotion read(const std::string& rows) {
  return stroke_in(kHeader + rows, kFile).motion;
}

TEST(MotionFile, IsPlayedBackLinearly) {
  const RecordedMotion motion = read("0,0,0,0,0,0,-1\n2,1,2,4,0,0,-1\n");
  EXPECT_FALSE(motion.position_is_free());
  EXPECT_EQ(motion.position_at(0.5), Vec3(0.25, 0.5, 1.0));
  EXPECT_EQ(motion.position_at(-1.0), Vec3(0, 0, 0));
  EXPECT_EQ(motion.position_at(3.0), Vec3(1, 2, 4));
}

TEST(MotionFile, HasItsAxesNormalised) {
  for (const char* axis : {"0,0,-1", "0,0,-1e-9", "0,0,-7", "0,0,-1e11"}) {
    EXPECT_EQ(read(std::string("0,0,0,0,") + axis + "\n").axis_at(0.0), Vec3(0, 0, -1)) << axis;
  }
  for (const char* axis : {"1e-13,0,0", "0,1e300,0", "1e200,1e200,1e200"})
    EXPECT_THROW(read(std::string("0,0,0,0,") + axis + "\n"), InputError) << axis;
}

/// A quarter of a turn about x takes the axis from -z to y.
TEST(MotionFileOfQuaternions, TurnsTheToolsFrameIntoTheWorlds) {
  const RecordedMotion motion = stroke_in(kQuaternions + "0,1,2,3,1,0,0,0\n1,1,2,3,0.7072,0.7072,0,0\n", kFile).motion;
  EXPECT_EQ(motion.axis_at(0.0), Vec3(0, 0, -1));
  EXPECT_LE((motion.axis_at(1.0) - Vec3(0, 1, 0)).norm(), 4e-16) << "normalised";
  EXPECT_EQ(motion.position_at(0.5), Vec3(1, 2, 3));
  EXPECT_TRUE(motion.scripts_roll());
  EXPECT_NO_THROW(stroke_in(kQuaternions + "1,0,0,0,0,1.0009,0,0\n", kFile)) << "within a thousandth";
  EXPECT_THROW(stroke_in(kQuaternions + "1,0,0,0,0,1.0011,0,0\n", kFile), InputError);
}

const std::string kTraceHeader = "time_s,x_m,y_m,z_m,ux,uy,uz,depth_m\n";

/// The message with which a trace of these rows is refused; empty when it is read.
std::string refusal(const std::string& rows) {
  try {
    trace_in(kTraceHeader + rows, "t.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TraceFile, HasContactsByTime) {
  const ContactTrace trace =
      trace_in(kTraceHeader + "0,1,2,3,0,0,-1,0.5\n0,4,5,6,1,0,0,0\n\n0.25,7,8,9,0,0.6,0.8,1e-3\n", "t.csv");
  ASSERT_EQ(trace.times.size(), 2u);
  EXPECT_EQ(trace.times[1].time, 0.25);
  EXPECT_EQ(trace.times[1].first, 2u);
  EXPECT_EQ(trace.most(), 2u);
  ASSERT_EQ(trace.contacts.size(), 3u);
  EXPECT_EQ(trace.contacts[0].point, Vec3(1, 2, 3));
  EXPECT_EQ(trace.contacts[2].gradient, Vec3(0, 0.6, 0.8));
  EXPECT_EQ(trace.contacts[2].depth, 1e-3);
  EXPECT_TRUE(trace_in(kTraceHeader, "t.csv").times.empty());
}

TEST(TraceFile, NormalisesRoundedGradientsAlone) {
  const double exact = 0.57735026918962573;
  const auto gradient = [](const std::string& text) {
    return trace_in(kTraceHeader + "0,0,0,0," + text + ",1\n", "t.csv").contacts[0].gradient;
  };
  EXPECT_EQ(gradient("0.57735026918962573,0.57735026918962573,0.57735026918962573"), Vec3::Constant(exact));
  EXPECT_NEAR(gradient("0.5774,0.5774,0.5774").norm(), 1.0, 1e-15);
}

TEST(TraceFile, IsRefusedWithItsRow) {
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,1\n0.1,0,0,0,0,0,1,1\n0.05,0,0,0,0,0,1,1\n"),
            "t.csv, contact 3: got time 0.05 after 0.1; allowed: ascending times");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1.01,1\n"),
            "t.csv, contact 1: got a gradient ux,uy,uz of length 1.01; allowed: 1 within 0.001");
  EXPECT_EQ(refusal("0,0,0,0,0,0,1,-1e-9\n"),
            "t.csv, contact 1: got depth -1e-09; allowed: >= 0, how deep the point is in the tool");
  EXPECT_NE(refusal("0,0,0\n"), "");
  std::string many;
  for (int i = 0; i < 100'001; ++i) many += "0,0,0,0,0,0,1,1\n";
  EXPECT_EQ(refusal(many), "t.csv, contact 100001: got more contacts at time 0; allowed: at most 100000");
  EXPECT_THROW(trace_in("time_s,x,y,z\n", "t.csv"), InputError);
  EXPECT_THROW(trace_in("", "t.csv"), InputError);
}

}  // namespace
}  // namespace hapbench::load_scenario_test
