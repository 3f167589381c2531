#include <gtest/gtest.h>

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::describe_scenario_test {
namespace {

// Tests the default values of a scenario. For each kind of scene, they are the values of the thesis (Tables A.1, A.2,
// B.1).

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

/// Returns the minimal scenario of an environment, changed by a JSON merge patch (RFC 7386).
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

TEST(Defaults, AreReplacedByGivenValues) {
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
  json["time"] = {{"step_s", 0.0005}, {"duration_s", 0.1}};  // 0.1 / 0.0005 is not exactly 200
  EXPECT_EQ(effective(json)["time"]["steps"], 200);
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

TEST(Object, HasNoMoreFaultsReportedThanAnybodyReads) {
  Json json = test::minimal_scenario("plane");
  for (std::size_t i = 0; i < 10 * kMaxFaults; ++i) json["key" + std::to_string(i)] = 0;
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->faults().size(), kMaxFaults);
}

}  // namespace
}  // namespace hapbench::describe_scenario_test
