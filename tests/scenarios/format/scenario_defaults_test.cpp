#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "results/io/columns.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// The values that a scenario has where its file says nothing, those of the thesis for that kind of scene (Tables A.1,
/// A.2, B.1), and the effective scenario: with every default filled in, a file that means the same.
namespace hapbench::scenario_defaults_test {
namespace {

struct Expected {
  const char* pointer;
  const char* json;
};

LoadedScenario loaded(const Json& json) {
  return read_scenario(json, "");
}
Json effective(const Json& json) {
  return effective_scenario(loaded(json).scenario, "");
}

void expect_fields(const Json& json, std::initializer_list<Expected> fields) {
  for (const Expected& field : fields) {
    EXPECT_EQ(json.at(Json::json_pointer(field.pointer)), Json::parse(field.json)) << field.pointer;
  }
}

/// The minimal scenario of an environment, changed by a JSON merge patch (RFC 7386).
Json patched(const std::string& environment, const char* patch) {
  Json json = test::minimal_scenario(environment);
  json.merge_patch(Json::parse(patch));
  return json;
}

TEST(Defaults, OfTheSceneAreThoseOfTheThesis) {
  for (const char* environment : {"springs", "hole_2d", "plane", "slot", "block_with_hole", "point_shell", "mesh"}) {
    SCOPED_TRACE(environment);
    const std::string name = environment;
    const bool springs = name == "springs", planar = springs || name == "hole_2d";
    expect_fields(effective(test::minimal_scenario(environment)),
                  {{"/rendering/mass_kg", planar ? "0.2" : "0.1"},
                   {"/rendering/friction", springs ? R"({"mu_s_N_s_per_m": 0.0, "mu_f_s_per_m": 0.0})"
                                                   : R"({"mu_s_N_s_per_m": 5.0, "mu_f_s_per_m": 10.0})"},
                   {"/rendering/reduction", "null"},
                   {"/tool", name == "hole_2d" ? R"({"diameter_m": 0.001, "length_m": 0.005, "tip": "round"})"
                                               : R"({"diameter_m": 0.001, "length_m": 0.01, "tip": "flat"})"},
                   {"/motion/orientation/up", planar ? "[0.0, 1.0, 0.0]" : "[0.0, 0.0, 1.0]"}});
  }
}

TEST(Defaults, GiveWayToWhatIsGiven) {
  expect_fields(effective(patched("hole_2d", R"({
                  "rendering": {"mass_kg": 1, "reduction": {"max_points": 5}, "friction": {"mu_s_N_s_per_m": 1}},
                  "tool": {"length_m": 1, "tip": "flat"}})")),
                {{"/rendering/mass_kg", "1.0"},
                 {"/rendering/reduction", R"({"threshold": 0.995, "max_points": 5, "shuffle_seed": null})"},
                 {"/rendering/friction", R"({"mu_s_N_s_per_m": 1.0, "mu_f_s_per_m": 10.0})"},
                 {"/tool", R"({"diameter_m": 0.001, "length_m": 1.0, "tip": "flat"})"}});
}

TEST(Duration, BecomesARoundedNumberOfSteps) {
  Json json = test::minimal_scenario("springs");
  json["time"] = {{"step_s", 1.0 / 2048.0}, {"duration_s", 1.0}};
  EXPECT_EQ(effective(json)["time"], Json::parse(R"({"step_s": 0.00048828125, "steps": 2048, "stop_when": []})"));
  json["time"] = {{"step_s", 0.0005}, {"duration_s", 0.1}};  // 0.1 / 0.0005 is not 200 to the last bit
  EXPECT_EQ(effective(json)["time"]["steps"], 200);
}

TEST(AdmittanceDevice, WarnsUnderAHandThatDoesNotFeelTheHandle) {
  const auto warnings = [](const char* hand, const char* device) {
    Json json = test::minimal_scenario("plane");
    json["hand"] = Json::parse(hand);
    json["device"] = Json::parse(device);
    return loaded(json).warnings;
  };
  constexpr const char* kDelay = R"({"type": "admittance", "servo": {"delay_samples": 20}})";
  for (const char* device : {kDelay, R"({"type": "admittance"})"}) {
    ASSERT_EQ(warnings(R"({"type": "none"})", device).size(), 1u) << device;
    EXPECT_EQ(warnings(R"({"type": "none"})", device)[0].told().find("/device: servo and mechanics"), 0u);
  }
  EXPECT_EQ(warnings(R"({"type": "push", "force_N": 1})", kDelay).size(), 1u);
  EXPECT_TRUE(warnings(R"({"type": "push", "force_N": 1})", R"({"type": "ideal"})").empty());
  EXPECT_TRUE(warnings(R"({"type": "none"})", R"({"type": "admittance", "sensor": {"noise_N": 0.02}})").empty())
      << "sensor and limiter work whatever the hand";
  EXPECT_TRUE(warnings(R"({"type": "impedance", "target": {"x_m": 0, "y_m": 0, "z_m": 0}})", kDelay).empty());
}

Json effective_device(const char* device) {
  Json json = test::minimal_scenario("plane");
  json["device"] = Json::parse(device);
  return effective(json)["device"];
}

TEST(ImpedanceDevice, WritesTheNumbersOfAPresetInFull) {
  const Json device = effective_device(R"({"type": "impedance", "preset": "touch", "force_max_N": null})");
  EXPECT_EQ(device, Json::parse(R"({"type": "impedance", "handle_mass_kg": 0.045, "viscous_N_s_per_m": 0.1,
    "coulomb_N": 0.2, "encoder_step_m": 5.5e-5, "delay_samples": 0.0, "velocity_filter": {"type": "difference"},
    "force_max_N": null, "force_step_N": 0.0, "force_slew_N_per_s": null, "position_filter": null,
    "position_noise_m": 0.0})"));
  EXPECT_EQ(effective_device(device.dump().c_str()), device) << "which is the same device again";
  EXPECT_EQ(effective_device(R"({"type": "impedance", "preset": "omega.3"})")["force_max_N"], 12.0);
}

TEST(ScenarioInCode, IsThatOfSpringsWithoutAnyField) {
  Json springs = test::minimal_scenario("springs");
  springs["time"]["steps"] = 1;
  EXPECT_EQ(effective_scenario(Scenario{}, ""), effective(springs));
}

TEST(ScenarioInCode, HasWhatAnotherAlgorithmFixes) {
  const Scenario given = loaded(test::minimal_scenario("plane")).scenario;
  for (const AlgorithmEntry& entry : algorithms()) {
    Json json = test::minimal_scenario("plane");
    json["rendering"]["algorithm"] = entry.info->name;
    EXPECT_EQ(effective_scenario(with_algorithm(given, entry.info->name), ""), effective(json)) << entry.info->name;
  }
}

namespace fs = std::filesystem;

std::string content_hash(const Scenario& scenario) {
  return scenario_hash(scenario, NamedFiles(scenario));
}

void expect_fixed_point(const Scenario& scenario, const fs::path& directory) {
  const Json effective = effective_scenario(scenario, directory);
  // Through text, as the file is.
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

}  // namespace
}  // namespace hapbench::scenario_defaults_test
