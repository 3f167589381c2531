#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::load_scenario_test {
namespace {

namespace fs = std::filesystem;

// Tests "extends" and `--set path=value`. tests/data/golden/refused_scenarios.txt has the errors of files that extend
// other files.

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

/// An object without a type has the first type of its field, such as a cylinder. Naming this type keeps its fields.
TEST_F(Extends, NamingTheTypeOfAnUntypedObjectKeepsItsFields) {
  write("untyped.json", R"({"tool": {"diameter_m": 0.004}, "rendering": {"friction": {"mu_s_N_s_per_m": 3}}})");
  const Json json = read_scenario_text(write("mine.json", R"({"extends": "untyped.json",
      "tool": {"type": "cylinder", "length_m": 0.03},
      "rendering": {"friction": {"type": "viscous", "mu_f_s_per_m": 2}}})"))
                        .json;
  EXPECT_EQ(json["tool"], Json::parse(R"({"diameter_m": 0.004, "type": "cylinder", "length_m": 0.03})"));
  EXPECT_EQ(json["rendering"]["friction"],
            Json::parse(R"({"mu_s_N_s_per_m": 3, "type": "viscous", "mu_f_s_per_m": 2})"));
  const Json other = read_scenario_text(write("mine.json", R"({"extends": "untyped.json",
      "tool": {"type": "bur", "shape": "round"}})"))
                         .json;
  EXPECT_EQ(other["tool"], Json::parse(R"({"type": "bur", "shape": "round"})"));
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
  EXPECT_TRUE(checked(loaded).file_warnings().empty());
  // The effective scenario names the file relative to its own folder, and extends nothing.
  const Json effective = effective_scenario(loaded.scenario, directory_.path());
  EXPECT_EQ(effective["environment"]["file"], "there/data/cube.obj");
  EXPECT_FALSE(effective.contains("extends"));
}

TEST_F(Extends, AnotherTimeStepReplacesTheSamplesOfADelayInSeconds) {
  // Both fields are given, as in an effective scenario: 0.0023 s are 4.6 steps of 0.0005 s.
  write("base.json", R"({"time": {"step_s": 0.0005, "steps": 20}, "environment": {"type": "plane"},
    "device": {"type": "impedance", "handle_mass_kg": 0.1, "delay_s": 0.0023, "delay_samples": 4.6}})");
  const auto samples = [&](const std::string& text) {
    const Scenario scenario = load_scenario(write("mine.json", text)).scenario;
    return std::get<ImpedanceDeviceConfig>(scenario.device).delay_samples;
  };
  EXPECT_EQ(samples(R"({"extends": "base.json"})"), 0.0023 / 0.0005);
  EXPECT_EQ(samples(R"({"extends": "base.json", "time": {"step_s": 0.001}})"), 0.0023 / 0.001);
  // A value that the extending file itself sets is kept.
  EXPECT_EQ(samples(R"({"extends": "base.json", "time": {"step_s": 0.001}, "device": {"delay_samples": 3}})"), 3.0);
}

TEST_F(Extends, AcceptsItselfInNoJsonInMemory) {
  Json json = Json::parse(kBase);
  json["extends"] = "poke_plane";
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->location_text(), "/extends");
}

constexpr const char* kScenario = R"({
  "name": "base",
  "time": {"step_s": 0.0005, "steps": 20},
  "environment": {"type": "springs",
    "groups": [{"direction": [1, 0, 0], "count": 2}, {"direction": [0, 1, 0], "count": 3}]},
  "rendering": {"reduction": {"threshold": 0.9}}
})";

class Override : public testing::Test {
 protected:
  Override() { test::write_plainly(file_, kScenario); }

  Json with(const std::vector<std::string>& overrides) const {
    return effective_scenario(load_scenario(file_, overrides).scenario, directory_.path());
  }
  /// Returns the message of the error for an override, without the file name at its beginning.
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
      // Indices select entries of lists.
      {{"environment.groups.1.count=9"}, "/environment/groups/1/count", "9"},
      {{"environment.groups.1.count=9"}, "/environment/groups/0/count", "2"},
      {{"environment.groups.0.direction.2=4"}, "/environment/groups/0/direction", "[1.0, 0.0, 4.0]"},
      // Missing objects are created.
      {{"rendering.limits.max_force_N=30"}, "/rendering/limits/max_force_N", "30.0"},
      {{"record.every=5"}, "/record/every", "5"},
      // Values may be JSON of every kind.
      {{"rendering.reduction=null"}, "/rendering/reduction", "null"},
      {{"rendering.local_average=false"}, "/rendering/local_average", "false"},
      {{"initial.position_m=[0.001, 0, -2e-3]"}, "/initial/position_m", "[0.001, 0.0, -0.002]"},
      {{R"(environment={"type":"plane"})"}, "/environment/type", "\"plane\""},
      {{"time.steps=1e3"}, "/time/steps", "1000"},
      // Numbers may be written as in other programs, although they are not JSON.
      {{"rendering.damping_ratio=.5"}, "/rendering/damping_ratio", "0.5"},
      {{"rendering.damping_ratio=+0.5"}, "/rendering/damping_ratio", "0.5"},
      {{"rendering.damping_ratio=1."}, "/rendering/damping_ratio", "1.0"},
      // Every other value is a text.
      {{"rendering.algorithm=mean"}, "/rendering/algorithm", "\"mean\""},
      {{R"(rendering.algorithm="mean")"}, "/rendering/algorithm", "\"mean\""},
      {{"description=a = b, c"}, "/description", "\"a = b, c\""},
      {{"description="}, "/description", "\"\""},
      // A later override takes precedence.
      {{"time.steps=7", "time.steps=8"}, "/time/steps", "8"},
      {{R"(rendering={"iterations":9})", "rendering.damping_ratio=0"}, "/rendering/iterations", "9"},
      // A field removes an earlier field with the same meaning.
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
  // The later of two overrides of delay_s and delay_samples replaces the other field.
  EXPECT_EQ(delays({"device.delay_samples=3"}), std::pair(-1.0, 3.0));
  EXPECT_EQ(delays({"device.delay_samples=3", "device.delay_s=0.001"}), std::pair(0.001, 0.001 / step));
  // The effective scenario has both fields and can be read again, also with another time step.
  const std::string both = "device=" + with({device}).at("device").dump();
  EXPECT_EQ(with({both}), with({device}));
  EXPECT_EQ(with({both, "time.step_s=0.0003"}), with({device, "time.step_s=0.0003"}));
  EXPECT_EQ(with({both, R"(time={"step_s":0.0003,"steps":20})"}), with({device, "time.step_s=0.0003"}));
  EXPECT_EQ(refusal(R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":0.0023,"delay_samples":2.3})")
                .find("/device/delay_s: got 0.0023 s together with delay_samples 2.3; allowed: one of the two, or both "
                      "with consistent values"),
            0u);
  EXPECT_NE(refusal(R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":-1})").find("/device/delay_s: got -1"),
            std::string::npos);
  EXPECT_EQ(
      refusal(R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":9000})").find("/device/delay_s: got 9000"),
      0u);
}

TEST_F(Override, IsCheckedLikeTheFile) {
  const std::pair<const char*, const char*> kRefusals[] = {
      {"rendering..iterations=1",
       "--set: got the path \"rendering..iterations\"; allowed: names with one dot between them"},
      {".=1", "--set: got the path \".\""},
      {"tool.=1", "--set: got the path \"tool.\""},
      {"extends=tap_wall", "/extends: got a base scenario outside of a file; allowed: only in a scenario file"},
      {"rendering.mass_kg=heavy", "/rendering/mass_kg: got \"heavy\"; allowed: a number > 0"},
      {"rendering.mass_kg=1e999", "/rendering/mass_kg: got \"1e999\""},
      {"seed.x=1", "/seed: got {\"x\":1}; allowed: an integer"},
      {"time.stop_when.0=leaves_hole", "/time/stop_when: got {"},  // missing: an object is created
      {"environment.groups.2.count=1", "environment.groups.2.count: got list index \"2\"; allowed: 0 ... 1"},
      {"environment.groups.-1=1", "environment.groups.-1: got list index \"-1\"; allowed: 0 ... 1"},
      {"environment.groups.99999999999999999999=1", "environment.groups.99999999999999999999: got list index"},
      {"=5", "--set: got \"=5\"; allowed: path=value, such as rendering.stiffness_N_per_m=40000"},
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

// Tests the effective scenario: a file with all defaults filled in and the same meaning.

std::string content_hash(const Scenario& scenario) {
  return scenario_hash(effective_scenario(scenario, {}), NamedFiles(scenario));
}

void expect_fixed_point(const Scenario& scenario, const fs::path& directory) {
  const Json effective = effective_scenario(scenario, directory);
  // Read the effective scenario from text, as from a file.
  const LoadedScenario again = read_scenario(parse_json(json_text(effective)), directory);
  EXPECT_EQ(json_text(effective_scenario(again.scenario, directory)), json_text(effective));
  for (const auto& [kind, pointer, text] : again.warnings) {
    EXPECT_TRUE(text.find("has no effect") != std::string::npos || text.ends_with("have no value")) << text;
  }
  EXPECT_EQ(content_hash(again.scenario), content_hash(scenario));
}

TEST(EffectiveScenario, OfEveryKindOfFieldIsAFixedPoint) {
  for (const auto& list : {test::minimal_scenarios(), test::rich_scenarios()}) {
    for (const test::NamedScenario& scenario : list) {
      SCOPED_TRACE(scenario.name);
      expect_fixed_point(read_scenario(scenario.json, test::data_directory()).scenario, test::data_directory());
    }
  }
}

TEST(ScenarioHash, FollowsTheContentsOfFilesNotTheirPaths) {
  const test::TemporaryDirectory directory;
  struct Case {
    const char *environment, *source, *more;
  };
  for (const Case& of : {Case{"point_shell", "shell.csv", "0,0,0,0,0,1\n"}, Case{"mesh", "cube.obj", "# more\n"}}) {
    const std::string end = fs::path(of.source).extension(),
                      contents = test::read_file(test::data_directory() / of.source);
    const auto hash_with = [&](const std::string& file, const std::string& text) {
      test::write_plainly(directory / (file + end), text);
      Json json = test::minimal_scenario(of.environment);
      json["environment"]["file"] = file + end;
      return content_hash(read_scenario(json, directory.path()).scenario);
    };
    const std::string hash = hash_with("a", contents);
    EXPECT_EQ(hash_with("b", contents), hash);
    EXPECT_NE(hash_with("b", contents + of.more), hash);
  }
}

TEST(ScenarioFromAPipe, HasAbsolutePathsOnly) {
  const auto relative = Json::parse(R"({"motion": {"position": {"type": "file", "file": "stroke.csv"}}})");
  const auto absolute = Json::parse(R"({"motion": {"position": {"type": "file", "file": "/data/stroke.csv"}}})");
  EXPECT_NO_THROW(require_absolute_paths("/dev/stdin", absolute));
  EXPECT_NO_THROW(require_absolute_paths("folder/scene.json", relative));
  const auto error = test::input_error_of([&] { require_absolute_paths("/dev/fd/63", relative); });
  ASSERT_TRUE(error);
  EXPECT_TRUE(std::string(error->what()).starts_with("/motion/position/file: got \"stroke.csv\"")) << error->what();
}

}  // namespace
}  // namespace hapbench::load_scenario_test
