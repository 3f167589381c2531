#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::relation_warnings_test {
namespace {

/// Returns the warnings about the scenario poke_plane with these overrides, without the file name at their beginning.
std::vector<std::string> warnings_with(std::vector<std::string> overrides) {
  std::vector<std::string> warnings;
  for (const Warning& warning : load_scenario(find_scenario("poke_plane"), overrides).warnings)
    warnings.push_back(warning.located_text());
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

TEST(Warnings, NameADampingRatioThatADampingReplaces) {
  EXPECT_TRUE(warnings_with({"rendering.damping_N_s_per_m=3"}).empty());
  const auto found = warnings_with({"rendering.damping_N_s_per_m=3", "rendering.damping_ratio=0.2"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "/rendering/damping_ratio: has no effect together with rendering.damping_N_s_per_m, which replaces it");
}

/// A script moves on after the end of the run, also if it has two waypoints only. A script that holds its last value
/// does not.
TEST(Warnings, NameAScriptThatIsLongerThanTheRun) {
  const auto script = [](const char* points) {
    return warnings_with({"time.duration_s=0.1",
                          std::string(R"(hand={"type":"force","z_N":{"type":"waypoints","points":)") + points + "}}"});
  };
  for (const char* points : {"[[0,-1],[0.5,-2]]", "[[0,-1],[0.05,-2],[0.5,-3]]", "[[0,-1],[0.5,-2],[0.6,-2]]"}) {
    ASSERT_EQ(script(points).size(), 1u) << points;
    EXPECT_NE(script(points)[0].find("last waypoint is at 0.5 s, but the run ends at 0.1"), std::string::npos);
  }
  for (const char* points : {"[[0,-1],[0.1,-2]]", "[[0,-1],[0.05,-2],[0.5,-2]]"})
    EXPECT_TRUE(script(points).empty()) << points;
}

TEST(Warnings, NameTheOverrideInsteadOfAFileThatDoesNotSetTheField) {
  const auto texts = [](std::vector<std::string> overrides) {
    const LoadedScenario loaded = load_scenario(find_scenario("poke_plane"), overrides);
    return with_files(loaded, loaded.warnings);
  };
  const std::string text = "poke_plane, overridden field rendering.iterations: has no effect on this algorithm";
  const auto found = texts({"rendering.algorithm=mean", "rendering.iterations=7"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].starts_with(text)) << found[0];
  // The text does not depend on the value, so that a sweep of the field warns once.
  EXPECT_EQ(texts({"rendering.iterations=8", "rendering.algorithm=mean"}), found);
}

TEST(AdmittanceDevice, WarnsUnderAHandThatDoesNotFeelTheHandle) {
  const auto warnings = [](const char* hand, const char* device) {
    Json json = test::minimal_scenario("plane");
    json["hand"] = Json::parse(hand);
    json["device"] = Json::parse(device);
    return read_scenario(json, "").warnings;
  };
  constexpr const char* kDelay = R"({"type": "admittance", "servo": {"delay_samples": 20}})";
  for (const char* device : {kDelay, R"({"type": "admittance"})"}) {
    ASSERT_EQ(warnings(R"({"type": "none"})", device).size(), 1u) << device;
    EXPECT_EQ(warnings(R"({"type": "none"})", device)[0].located_text().find("/device: servo and mechanics"), 0u);
  }
  EXPECT_EQ(warnings(R"({"type": "push", "force_N": 1})", kDelay).size(), 1u);
  EXPECT_TRUE(warnings(R"({"type": "push", "force_N": 1})", R"({"type": "ideal"})").empty());
  EXPECT_TRUE(warnings(R"({"type": "none"})", R"({"type": "admittance", "sensor": {"noise_N": 0.02}})").empty())
      << "sensor and limiter work whatever the hand";
  EXPECT_TRUE(warnings(R"({"type": "impedance", "target": {"x_m": 0, "y_m": 0, "z_m": 0}})", kDelay).empty());
}

/// Checks the warnings about a device whose fields are given in millimetres or grams instead of metres and kilograms.
/// Presets, and devices that are really light or heavy, cause no warning.
TEST(ImpedanceDevice, WarnsOfNumbersThatNoDeviceHas) {
  const auto warnings = [](const std::string& fields) {
    return warnings_with({R"(device={"type":"impedance",)" + fields + "}"});
  };
  for (const auto& [fields, field] : {std::pair{R"("handle_mass_kg":80)", "/device/handle_mass_kg"},
                                      {R"("handle_mass_kg":1e-4)", "/device/handle_mass_kg"},
                                      {R"("preset":"touch","encoder_step_m":0.02)", "/device/encoder_step_m"},
                                      {R"("preset":"touch","position_noise_m":0.05)", "/device/position_noise_m"},
                                      {R"("preset":"touch","coulomb_N":200)", "/device/coulomb_N"},
                                      {R"("preset":"touch","delay_samples":1000)", "/device/delay_samples"}}) {
    const auto found = warnings(fields);
    ASSERT_EQ(found.size(), 1u) << fields;
    EXPECT_TRUE(found[0].starts_with(field)) << found[0];
    EXPECT_NE(found[0].find("; haptic devices have "), std::string::npos) << found[0];
  }
  for (const char* fields : {R"("preset":"touch")", R"("preset":"omega.3")", R"("handle_mass_kg":10)",
                             R"("handle_mass_kg":0.002,"encoder_step_m":0.0009)"})
    EXPECT_TRUE(warnings(fields).empty()) << fields;
}

}  // namespace
}  // namespace hapbench::relation_warnings_test
