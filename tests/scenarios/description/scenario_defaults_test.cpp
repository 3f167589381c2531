#include <fmt/format.h>
#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/json_file.hpp"
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

TEST(Defaults, ThatHoldEverywhere) {
  for (const test::NamedScenario& scenario : test::minimal_scenarios()) {
    SCOPED_TRACE(scenario.name);
    expect_fields(effective(scenario.json),
                  {{"/seed", "1"},
                   {"/time", R"({"step_s": 0.0005, "steps": 20, "stop_when": []})"},
                   {"/initial", R"({"position_m": [0.0, 0.0, 0.0], "velocity_m_per_s": [0.0, 0.0, 0.0]})"},
                   {"/tool/diameter_m", "0.001"},
                   {"/motion/orientation/lean", "[1.0, 0.0, 0.0]"},
                   {"/motion/orientation/tilt_rad", "0.0"},
                   {"/motion/orientation/azimuth_rad", "0.0"},
                   {"/motion/orientation/roll_rad", "0.0"},
                   {"/motion/position", R"({"type": "free"})"},
                   {"/hand", R"({"type": "none"})"},
                   {"/device", R"({"type": "ideal", "force_limit_N": null})"},
                   {"/rendering/algorithm", "\"shaped_stiffness\""},
                   {"/rendering/iterations", "3"},
                   {"/rendering/depth_model", "\"surface_normal\""},
                   {"/rendering/local_average", "false"},
                   {"/rendering/passivity_controller", "false"},
                   {"/rendering/stiffness_N_per_m", "20000.0"},
                   {"/rendering/damping_ratio", "0.7"},
                   {"/rendering/damping_N_s_per_m", "null"},
                   {"/rendering/angular_damping", "false"},
                   {"/rendering/angular_velocity_cutoff_Hz", "20.0"},
                   {"/rendering/limits", R"({"max_damping_N_s_per_m": null, "max_force_N": null})"},
                   {"/rendering/virtual_coupling_N_per_m", "null"},
                   {"/rendering/regularisation", "0.01"},
                   {"/integrator", R"({"type": "leapfrog"})"},
                   {"/record", R"({"trajectory": true, "every": 1, "ratio_iterations": [], "contacts": false,
                                   "stiffness_tensor": false, "timing": false, "energy": false, "ideal_trajectory": false,
                                   "force_reference": false, "pose": false, "torque": false,
                                   "inside": false})"},
                   {"/rendering/reduction", "null"},
                   {"/metrics", R"({"from_s": null, "settling_s": 0.05})"},
                   {"/expect/outcome", R"(["completes", "leaves_hole", "tool_horizontal"])"}});
  }
}

TEST(Defaults, OfSpringsAreThoseOfA2) {
  expect_fields(effective(test::minimal_scenario("springs")),
                {{"/rendering/mass_kg", "0.2"},
                 {"/rendering/friction", R"({"mu_s_N_s_per_m": 0.0, "mu_f_s_per_m": 0.0})"},
                 {"/rendering/reduction", "null"},
                 {"/motion/orientation/up", "[0.0, 1.0, 0.0]"},
                 {"/environment/bilateral", "true"},
                 {"/environment/signed", "true"},
                 {"/environment/groups", "[]"},
                 {"/environment/random", R"({"count": 0, "planar": true})"}});
}

TEST(Defaults, OfTheHoleAreThoseOfTableA1) {
  expect_fields(effective(test::minimal_scenario("hole_2d")),
                {{"/environment", R"({"type": "hole_2d", "width_m": 0.001, "depth_m": 0.005, "spacing_m": 0.0001,
                                      "mouth_m": 0.003})"},
                 {"/tool", R"({"diameter_m": 0.001, "length_m": 0.005, "tip": "round"})"},
                 {"/rendering/mass_kg", "0.2"},
                 {"/rendering/friction", R"({"mu_s_N_s_per_m": 5.0, "mu_f_s_per_m": 10.0})"},
                 {"/rendering/reduction", "null"},
                 {"/motion/orientation/up", "[0.0, 1.0, 0.0]"}});
}

TEST(Defaults, OfSpatialScenesAreThoseOfThePlatform) {
  for (const char* environment : {"plane", "slot", "block_with_hole", "point_shell", "mesh"}) {
    SCOPED_TRACE(environment);
    expect_fields(effective(test::minimal_scenario(environment)),
                  {{"/tool", R"({"diameter_m": 0.001, "length_m": 0.01, "tip": "flat"})"},
                   {"/rendering/mass_kg", "0.1"},
                   {"/rendering/friction", R"({"mu_s_N_s_per_m": 5.0, "mu_f_s_per_m": 10.0})"},
                   {"/rendering/reduction", "null"},
                   {"/motion/orientation/up", "[0.0, 0.0, 1.0]"}});
  }
}

TEST(Defaults, OfTheBlockAreTheExperimentsPart) {
  expect_fields(
      effective(test::minimal_scenario("block_with_hole")),
      {{"/environment", R"({"type": "block_with_hole", "size_m": [0.015, 0.015, 0.01], "hole_diameter_m": 0.002,
                                      "hole_depth_m": 0.005, "grid_m": 0.0001, "density": "signed_distance",
                                      "vertices": "shared"})"}});
}

TEST(Defaults, OfAPartlyGivenObjectFillTheRest) {
  expect_fields(effective(patched("plane", R"({"rendering": {"reduction": {"max_points": 5}, "friction":
                                               {"mu_s_N_s_per_m": 1}}, "tool": {"tip": "round"}})")),
                {{"/rendering/reduction", R"({"threshold": 0.995, "max_points": 5, "shuffle_seed": null})"},
                 {"/rendering/friction", R"({"mu_s_N_s_per_m": 1.0, "mu_f_s_per_m": 10.0})"},
                 {"/tool", R"({"diameter_m": 0.001, "length_m": 0.01, "tip": "round"})"}});
}

TEST(Defaults, GiveWayToWhatIsGiven) {
  expect_fields(effective(patched("hole_2d", R"({"rendering": {"mass_kg": 1, "reduction": {}, "depth_model":
                             "normal_projection"}, "tool": {"length_m": 1, "tip": "flat"}})")),
                {{"/rendering/mass_kg", "1.0"},
                 {"/rendering/reduction/threshold", "0.995"},
                 {"/rendering/depth_model", "\"normal_projection\""},
                 {"/tool/length_m", "1.0"},
                 {"/tool/tip", "\"flat\""}});
  // merge_patch deletes on null, so null is set by hand.
  Json json = test::minimal_scenario("plane");
  json["rendering"]["reduction"] = nullptr;
  expect_fields(effective(json), {{"/rendering/reduction", "null"}});
}

TEST(Duration, BecomesARoundedNumberOfSteps) {
  Json json = test::minimal_scenario("springs");
  json["time"] = {{"step_s", 1.0 / 2048.0}, {"duration_s", 1.0}};
  EXPECT_EQ(effective(json)["time"], Json::parse(R"({"step_s": 0.00048828125, "steps": 2048, "stop_when": []})"));
  json["time"] = {{"step_s", 0.0005}, {"duration_s", 0.1}};  // 0.1 / 0.0005 is not 200 to the last bit
  EXPECT_EQ(effective(json)["time"]["steps"], 200);
}

TEST(FixedDepthModel, OverridesAnotherOneWithAWarning) {
  for (const auto& [algorithm, fixed, other] : {std::tuple{"original_averaging", "shortest_distance", "surface_normal"},
                                                {"normal_projection", "normal_projection", "shortest_distance"}}) {
    Json json = test::minimal_scenario("plane");
    json["rendering"] = {{"algorithm", algorithm}};
    EXPECT_TRUE(loaded(json).warnings.empty());
    EXPECT_EQ(loaded(json).scenario.rendering.depth_model, fixed);
    json["rendering"]["depth_model"] = fixed;
    EXPECT_TRUE(loaded(json).warnings.empty());
    json["rendering"]["depth_model"] = other;
    EXPECT_EQ(loaded(json).scenario.rendering.depth_model, fixed);
    ASSERT_EQ(loaded(json).warnings.size(), 1u);
    EXPECT_EQ(loaded(json).warnings[0].told(),
              fmt::format("/rendering/depth_model: \"{}\" is not used: algorithm \"{}\" is defined with \"{}\"", other,
                          algorithm, fixed));
  }
}

TEST(OriginalAveraging, RunsWithoutReductionAndWarnsAboutAGivenOne) {
  Json json = test::minimal_scenario("plane");
  json["rendering"] = {{"algorithm", "original_averaging"}};
  EXPECT_EQ(effective(json)["rendering"]["reduction"], nullptr);
  json["rendering"]["reduction"] = Json::object();
  const LoadedScenario scenario = loaded(json);
  EXPECT_EQ(effective(json)["rendering"]["reduction"], nullptr);
  ASSERT_EQ(scenario.warnings.size(), 1u);
  EXPECT_EQ(scenario.warnings[0].told().find("/rendering/reduction: not used"), 0u);
  json["rendering"]["reduction"] = nullptr;
  EXPECT_TRUE(loaded(json).warnings.empty());
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

TEST(ImpedanceDevice, WarnsOfAnIntegratorThatIsNotUsed) {
  Json json = test::minimal_scenario("plane");
  json["device"] = {{"type", "impedance"}, {"preset", "touch"}};
  EXPECT_TRUE(loaded(json).warnings.empty());
  json["integrator"] = {{"type", "rk4"}};
  ASSERT_EQ(loaded(json).warnings.size(), 1u);
  EXPECT_EQ(loaded(json).warnings[0].told().find("/integrator/type: \"rk4\" is not used"), 0u);
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

TEST(Orientation, IsThatOfARecordedMotionAlone) {
  Json json = test::minimal_scenario("plane");
  json["motion"]["position"] = {{"type", "file"}, {"file", "stroke.csv"}};
  EXPECT_FALSE(loaded(json).scenario.motion.orientation);
  json["motion"]["orientation"] = Json::object();
  const auto error = test::input_error_of([&] { loaded(json); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place(), "/motion/orientation");
}

TEST(Orientation, WantsPerpendicularDirections) {
  for (const char* orientation :
       {R"({"up": [0, 0, 1], "lean": [0, 0, 1]})", R"({"up": [0, 0, 0]})", R"({"lean": [0, 0, 0]})",
        R"({"up": [1, 0, 0]})", R"({"up": [1e-200, 0, 0], "lean": [0, 1, 0]})", R"({"lean": [1, 0, 1e-8]})"}) {
    Json json = test::minimal_scenario("plane");
    json["motion"]["orientation"] = Json::parse(orientation);
    const auto error = test::input_error_of([&] { loaded(json); });
    ASSERT_TRUE(error) << orientation;
    EXPECT_EQ(error->kind(), InputError::Kind::relation);
    EXPECT_EQ(error->place(), "/motion/orientation");
  }
}

TEST(Orientation, ForgivesTheRoundingOfNormalisedDirections) {
  Json json = test::minimal_scenario("plane");
  json["motion"]["orientation"] = Json::parse(R"({"up": [0.6, 0, 0.8], "lean": [0.8, 0, -0.6000000000000001]})");
  EXPECT_NO_THROW(loaded(json));
}

TEST(LocalAverage, NeedsAGrid) {
  Json springs = test::minimal_scenario("springs"), shell = test::minimal_scenario("point_shell");
  Json mesh = test::minimal_scenario("mesh");
  for (Json* json : {&springs, &shell, &mesh}) (*json)["rendering"]["local_average"] = true;
  for (const Json& json : {springs, shell, mesh}) {
    const auto error = test::input_error_of([&] { loaded(json); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->place(), "/rendering/local_average");
  }
  for (Json* json : {&shell, &mesh}) {
    (*json)["environment"]["grid_m"] = 0.001;
    EXPECT_NO_THROW(loaded(*json));
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

TEST(EffectiveScenario, OfEveryBundledScenarioIsAFixedPoint) {
  for (const BundledScenario& bundled : bundled_scenarios()) {
    SCOPED_TRACE(bundled.name);
    expect_fixed_point(load_scenario(bundled.file).scenario, bundled.file.parent_path());
  }
}

TEST(EffectiveScenario, OfEveryKindOfFieldIsAFixedPoint) {
  for (const auto& list : {test::minimal_scenarios(), test::rich_scenarios()}) {
    for (const test::NamedScenario& scenario : list) {
      SCOPED_TRACE(scenario.name);
      expect_fixed_point(read_scenario(scenario.json, test::data_directory()).scenario, test::data_directory());
    }
  }
}

TEST(EffectiveScenario, KeepsGivenNumbersToTheLastBit) {
  Json json = test::minimal_scenario("plane");
  const double numbers[] = {0.1, 1.0 / 3.0, 1e-300, 123456789.123456789};
  for (const double number : numbers) {
    json["rendering"]["stiffness_N_per_m"] = number;
    const Json effective = effective_scenario(read_scenario(json, "").scenario, "");
    EXPECT_EQ(parse_json(json_text(effective))["rendering"]["stiffness_N_per_m"].get<double>(), number);
  }
}

class EffectivePaths : public testing::Test {
 protected:
  EffectivePaths() {
    fs::create_directories(directory_ / "scenes here/data");
    fs::create_directories(directory_ / "out/deep/er");
    fs::copy_file(test::data_directory() / "shell.csv", shell_);
    Json json = test::minimal_scenario("point_shell");
    json["environment"]["file"] = "data/shell.csv";
    test::write_plainly(scenario_, json.dump());
  }
  /// The file to which the path in the effective scenario of `output` leads.
  fs::path file_from(const fs::path& output) const {
    const Json effective = effective_scenario(load_scenario(scenario_).scenario, output);
    return fs::canonical(output / effective["environment"]["file"].get<std::string>());
  }

  test::TemporaryDirectory directory_;
  fs::path scenario_ = directory_ / "scenes here/scene.json";
  fs::path shell_ = directory_ / "scenes here/data/shell.csv";
};

TEST_F(EffectivePaths, LeadFromTheOutputDirectoryToTheSameFile) {
  for (const char* output : {"out", "out/deep/er", "scenes here", "scenes here/data", "."}) {
    EXPECT_EQ(file_from(directory_ / output), fs::canonical(shell_)) << output;
  }
}

TEST_F(EffectivePaths, LeadThereThroughLinksToo) {
  fs::create_directory_symlink(directory_ / "out/deep/er", directory_ / "link");
  EXPECT_EQ(file_from(directory_ / "link"), fs::canonical(shell_));
  fs::create_directory_symlink(directory_ / "scenes here", directory_ / "out/scenes");
  const Json effective =
      effective_scenario(load_scenario(directory_ / "out/scenes/scene.json").scenario, directory_ / "link");
  EXPECT_EQ(fs::canonical(directory_ / "link" / effective["environment"]["file"].get<std::string>()),
            fs::canonical(shell_));
}

TEST_F(EffectivePaths, MayBeAbsolute) {
  Json json = test::minimal_scenario("point_shell");
  json["environment"]["file"] = shell_.string();
  test::write_plainly(scenario_, json.dump());
  EXPECT_EQ(file_from(directory_ / "out"), fs::canonical(shell_));
}

TEST_F(EffectivePaths, WorkForAScenarioOfTheCurrentDirectory) {
  // Its directory is the empty path.
  EXPECT_NO_THROW(effective_scenario(read_scenario(test::minimal_scenario("point_shell"), "").scenario, ""));
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

TEST(ScenarioHash, DiffersWhenAnyFieldDiffers) {
  const auto hash_with = [](const char* patch) {
    Json json = test::minimal_scenario("plane");
    json.merge_patch(Json::parse(patch));
    return content_hash(read_scenario(json, "").scenario);
  };
  const std::string hash = hash_with("{}");
  EXPECT_EQ(hash_with(R"({"rendering": {"stiffness_N_per_m": 2e4}})"), hash);
  for (const char* patch : {R"({"rendering": {"stiffness_N_per_m": 20000.000000000004}})", R"({"seed": 2})",
                            R"({"time": {"steps": 21}})", R"({"record": {"contacts": true}})"}) {
    EXPECT_NE(hash_with(patch), hash) << patch;
  }
}

}  // namespace
}  // namespace hapbench::scenario_defaults_test
