#include <gtest/gtest.h>

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include "algorithms/registry.hpp"
#include "results/observe/metrics.hpp"
#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/outcome.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/scene/tools.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/run/diagnosed_scene.hpp"
#include "tests/scenarios/support/bundled.hpp"

namespace hapbench::diagnosis_test {
namespace {

namespace fs = std::filesystem;
using test::finding, test::run, test::run_of_text, test::Scene, test::Words;

// Tests the diagnosis of runs with a fault. For very similar runs without the fault, the diagnosis must not report it.

/// Expects that a finding names a frequency [Hz] near `expected`.
void expect_frequency(const Diagnosed& found, double expected, double tolerance) {
  std::smatch frequency;
  ASSERT_TRUE(std::regex_search(found.says, frequency, std::regex("; the frequency is about ([0-9]+) Hz")))
      << found.says;
  EXPECT_NEAR(std::stod(frequency[1]), expected, tolerance);
}

struct Pair {
  const char* rule;
  Scene with, without;
};

const std::string kOmega = R"(device={"type":"impedance","preset":"omega.3"})";

std::vector<Pair> pairs() {
  const Scene molar = {"drag_molar"};
  return {
      {"diverged", {"single_spring_unstable"}, {"single_spring"}},
      {"sank", {"mesh_molar", {"rendering.stiffness_N_per_m=500"}}, {"mesh_molar"}},
      {"lost", {"mesh_molar", {"initial.position_m=[0,0,0.1]", "hand.z_N=1.5"}}, {"mesh_molar"}},
      {"stuck", {"drag_molar_dry", {"rendering.friction.mu=5"}}, {"drag_molar_dry"}},
      {"step", {"mesh_molar", {"time.step_s=1", "time.steps=5"}}, {"mesh_molar", {"time.steps=5"}}},
      {"servo",
       {"device_at_wall", {"device.servo.delay_samples=20"}},
       {"drag_molar", {"rendering.stiffness_N_per_m=2e6"}}},
      {"edge", {"drag_molar", {"rendering.stiffness_N_per_m=2e6"}}, molar},
      // In bounce_molar, no hand presses the ball onto the tooth, so there is no equilibrium in contact.
      {"edge",
       {"bounce_molar", {"rendering.stiffness_N_per_m=3e6"}},
       {"bounce_molar", {"rendering.stiffness_N_per_m=157", "rendering.damping_ratio=7.5"}}},
      {"buzz", {"drag_molar", {kOmega}}, molar},
      {"pop", {"drag_molar", {kOmega}}, molar},
      {"reduction",
       {"mesh_molar", {R"(rendering.reduction={"threshold":0.9})"}},
       {"mesh_molar", {R"(rendering.reduction=null)"}}},
      {"loop", {"single_spring", {"rendering.damping_N_s_per_m=500"}}, {"single_spring_unstable"}},
      {"shake", {"peg_in_hole_2d_original_averaging"}, {"peg_in_hole_2d_shaped_stiffness"}},
      {"facets", {"bur_fissure", {"environment.spacing_m=0.0006"}}, {"bur_fissure"}},
      {"deep", {"impedance_at_wall", {"rendering.stiffness_N_per_m=3600"}}, {"impedance_at_wall"}},
      {"soft", {"corner_shaped_stiffness", {"rendering.algorithm=mean"}}, {"corner_shaped_stiffness"}},
      {"hard", {"drag_molar", {"rendering.algorithm=summation"}}, molar},
      {"damping",
       {"drag_molar", {"rendering.damping_ratio=8"}},
       {"drag_molar", {"rendering.damping_ratio=8", "integrator.type=implicit_euler"}}},
      {"friction", {"drag_molar", {"rendering.friction.mu_f_s_per_m=1000"}}, molar},
      {"encoder", {"drag_molar", {kOmega}}, {"drag_molar", {kOmega, "device.encoder_step_m=0"}}},
      {"saturated",
       {"impedance_at_wall", {"device.force_max_N=0.5"}},
       {"impedance_at_wall", {"device.force_max_N=10"}}},
      {"limiter", {"device_at_wall", {"device.force_limit_N=0.3"}}, {"device_at_wall"}},
      {"bounces", {"bounce_plane", {R"(hand={"type":"force","z_N":-0.2})", "time.steps=4000"}}, {"bounce_plane"}},
      {"chatter", {"drag_molar", {kOmega}}, molar},
      {"energy", {"peg_in_hole_2d_original_averaging"}, {"peg_in_hole_2d_mean"}},
      {"drift",
       {"incline_dry", {"hand.x_N=0.4", R"(rendering.friction={"mu_s_N_s_per_m":5,"mu_f_s_per_m":10})"}},
       {"incline_dry", {"hand.x_N=0.4"}}},
  };
}

/// Writes the stroke of recorded_wipe with the opposite sign of the measured force.
void write_reversed_force(const fs::path& file) {
  std::ifstream stroke(find_scenario("recorded_wipe").parent_path() / "data/wipe.csv");
  std::string text, line;
  for (bool is_header = true; std::getline(stroke, line); is_header = false) {
    Words cells = csv_cells(line);
    for (std::size_t i = cells.size() - 3; !is_header && i < cells.size(); ++i)
      cells[i] = cells[i].starts_with('-') ? cells[i].substr(1) : "-" + cells[i];
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  test::write_plainly(file, text);
}

TEST(Diagnosis, EachRuleFindsItsFaultAndIsSilentWithout) {
  const test::TemporaryDirectory directory;
  write_reversed_force(directory / "reversed.csv");
  std::vector<Pair> all = pairs();
  all.push_back({"force_sign",
                 {"recorded_wipe", {"motion.position.file=" + fs::absolute(directory / "reversed.csv").string()}},
                 {"recorded_wipe"}});
  // Load a law that gives the force of `mean`. If HOSTILE is "nan", it gives NaN; if it is "inward", the opposite
  // force.
  load_module(fs::canonical(HAPBENCH_TEST_MODULES) / "hostile.so");
  std::set<std::string> tested = {"fault"};
  const Scene hostile = {"single_spring", {"rendering.algorithm=hostile"}};
  EXPECT_EQ(finding(run(hostile), "fault"), nullptr);
  {
    const test::EnvironmentVariable nan("HOSTILE", "nan");
    const Result faulty = run(hostile);
    EXPECT_NE(finding(faulty, "fault"), nullptr);
    EXPECT_EQ(faulty.diagnosis->size(), 1u) << "advice about step and K does not fit a fault of the law";
  }
  {
    const Scene molar = {"mesh_molar", {"rendering.algorithm=hostile"}};
    EXPECT_EQ(finding(run(molar), "inward"), nullptr);
    const test::EnvironmentVariable inward("HOSTILE", "inward");
    const Result pulled = run(molar);
    EXPECT_NE(finding(pulled, "inward"), nullptr);
    const Diagnosed* sank = finding(pulled, "sank");
    ASSERT_NE(sank, nullptr);
    EXPECT_EQ(sank->attempt.find('K'), std::string::npos) << "no K helps: " << sank->attempt;
    // The law can also be the cause of other findings. The limiter cuts the hand's force whatever the law renders.
    std::set<std::string> others;
    for (const char* scene : {"mesh_molar", "peg_in_hole_2d_shaped_stiffness", "rotate_in_hole", "device_at_wall"}) {
      const Result other = run({scene, {"rendering.algorithm=hostile"}});
      for (const Diagnosed& found : *other.diagnosis) {
        others.insert(found.rule);
        const bool names_law = found.attempt.find("\"inward\"") != std::string::npos;
        EXPECT_TRUE(names_law || (found.rule != "sank" && found.rule != "soft")) << scene << ", " << found.rule;
        EXPECT_FALSE(names_law && found.rule == "limiter") << scene << ": " << found.attempt;
      }
    }
    for (const char* rule : {"sank", "soft", "limiter"}) EXPECT_TRUE(others.contains(rule)) << rule;
    // If a script moves the tool, the law does not determine how deep the tool is.
    const Result wiped = run({"recorded_wipe", {"rendering.algorithm=hostile", "rendering.limits.max_force_N=0.1"}});
    EXPECT_NE(finding(wiped, "inward"), nullptr);
    const Diagnosed* saturated = finding(wiped, "saturated");
    ASSERT_NE(saturated, nullptr);
    EXPECT_EQ(saturated->attempt.find("\"inward\""), std::string::npos) << saturated->attempt;
    tested.insert("inward");
  }
  for (const Pair& pair : all) {
    const Diagnosed* found = finding(run(pair.with), pair.rule);
    EXPECT_NE(found, nullptr) << pair.rule << " in " << pair.with.name;
    EXPECT_EQ(finding(run(pair.without), pair.rule), nullptr) << pair.rule << " in " << pair.without.name;
    tested.insert(pair.rule);
  }
  for (const Diagnosed& rule : diagnosis_rules()) EXPECT_TRUE(tested.contains(rule.rule)) << rule.rule;
}

TEST(Diagnosis, IsSilentWhereNothingIsWrong) {
  for (const char* scene :
       {"drag_molar", "mesh_molar", "bur_fissure", "device_at_wall", "device_in_hole", "impedance_at_wall", "tap_wall",
        "drag_molar_dry", "plane_pressed_round", "cone_in_undercut", "recorded_wipe", "incline_dry", "single_spring",
        "random_springs", "wedge_stiffness"}) {
    const Result result = run({scene});
    for (const Diagnosed& found : *result.diagnosis) ADD_FAILURE() << scene << ": " << found.says;
  }
}

TEST(Diagnosis, NamesNoOutcomeThatTheSceneExpects) {
  for (const auto& [scene, outcome, rule] : {std::tuple{"single_spring_unstable", "diverges", "diverged"},
                                             std::tuple{"flat_press_normal_projection", "went_through", "sank"}}) {
    const Result expected = run({scene, {fmt::format("expect.outcome={}", outcome)}});
    EXPECT_EQ(finding(expected, rule), nullptr) << scene;
    const Result unexpected = run({scene});
    EXPECT_NE(finding(unexpected, rule), nullptr) << scene;
  }
}

/// Checks the reported frequency. An undamped spring of 20 000 N/m and 0.1 kg oscillates at 71.2 Hz. The last quarter
/// of the run takes half a second, so an error of half an oscillation in the count is an error of 1 Hz.
TEST(Diagnosis, ReportsTheFrequencyOfABuzz) {
  const Result result = run({"single_spring", {"rendering.damping_ratio=0.0005", "time.steps=4000"}});
  const Diagnosed* buzz = finding(result, "buzz");
  ASSERT_NE(buzz, nullptr);
  expect_frequency(*buzz, 71.2, 1.5);
}

/// Checks a hand that presses a ball on a plane with 1.2 N and shakes it at 40 Hz with 0.8 N. The force of the contact
/// also has harmonics. The peaks of the spectrum are at most half a bin of 1 / (4 * 0.5 s) from their frequency.
TEST(Diagnosis, ReportsTheFundamentalFrequencyOfABuzz) {
  const Result result = run_of_text(R"({
    "time": {"step_s": 0.0005, "duration_s": 2},
    "environment": {"type": "plane", "size_m": 0.02, "spacing_m": 0.0002}, "initial": {"position_m": [0, 0, 0.002]},
    "tool": {"diameter_m": 0.002, "length_m": 0.02, "tip": "round"},
    "hand": {"type": "force",
             "z_N": {"type": "sine", "mean": -1.2, "amplitude": 0.8, "period_s": 0.025, "phase_rad": 0}},
    "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 20000, "damping_ratio": 0.7, "mass_kg": 0.1}
  })");
  const Diagnosed* const found = finding(result, "buzz");
  ASSERT_NE(found, nullptr);
  expect_frequency(*found, 40.0, 1.0);
}

/// Checks the energy that the motors of an impedance device give to the hand. With a delay, they give energy that the
/// rendered force alone would not give. If they saturate, they do not give the energy that the rendered force would.
TEST(Diagnosis, ComparesTheEnergyAtTheHandle) {
  const Result delayed = run(
      {"tap_wall", {"rendering.stiffness_N_per_m=2000", "rendering.damping_N_s_per_m=2", "device.delay_samples=4"}});
  ASSERT_NE(finding(delayed, "energy"), nullptr);
  EXPECT_EQ(number_of(delayed.metrics, "passivity.net_created_J"), 0.0);
  EXPECT_NE(finding(delayed, "energy")->says.find("motors"), std::string::npos) << finding(delayed, "energy")->says;
  const Result saturated =
      run({"tap_wall", {"rendering.stiffness_N_per_m=30000", "rendering.damping_ratio=0", "device.force_max_N=1"}});
  EXPECT_GT(number_of(saturated.metrics, "passivity.net_created_J").value(), 1e-3);
  EXPECT_EQ(finding(saturated, "energy"), nullptr);
}

/// Checks that no advice names K or the algorithm if the loop is unstable without contact.
TEST(Diagnosis, AdvisesOnlyTheServoIfItAloneIsUnstable) {
  const Result result = run({"device_at_wall", {"device.servo.delay_samples=4"}});
  ASSERT_NE(finding(result, "servo"), nullptr);
  EXPECT_GT(result.diagnosis->size(), 1u);
  for (const Diagnosed& found : *result.diagnosis) {
    EXPECT_EQ(found.attempt.find("smaller K"), std::string::npos) << found.rule << ": " << found.attempt;
    EXPECT_EQ(found.attempt.find("algorithm"), std::string::npos) << found.rule << ": " << found.attempt;
  }
}

/// Checks that a vibration along the normal is no path along the surface.
TEST(Diagnosis, CountsThePathAlongTheSurface) {
  const LoadedScenario loaded = load_scenario(find_scenario("drag_molar"), {});
  DiagnosisObserver observer(loaded.scenario);
  StepRecord record;
  record.colliding = 1;
  record.force.spring = {0.0, 0.0, 2.0};
  for (int i = 0; i < 10; ++i, ++record.step) {
    record.tool.pose.position = {1e-3 * i, 0.0, i % 2 == 0 ? 0.0 : 1e-3};
    observer.on_step(record);
  }
  EXPECT_NEAR(observer.rows().path_in_contact, 9e-3, 1e-15);  // rounding
}

/// Checks that the advice does not name the law that is in use.
TEST(Diagnosis, AdvisesNoLawThatIsInUse) {
  const LoadedScenario loaded = load_scenario(find_scenario("drag_molar"), {});
  const auto tool = make_tool(loaded.scenario, loaded.files);
  for (const std::string& law : algorithm_names()) {
    Result result;
    result.algorithm = law;
    result.metrics = {
        {"ratio_min", "1", "", 0.1}, {"ratio_max", "1", "", 10.0}, {"force_reversals_per_s", "1/s", "", 100.0}};
    const auto findings = diagnosis_findings(loaded, result, DiagnosisObserver(loaded.scenario).rows(), *tool);
    EXPECT_EQ(findings.size(), 4u) << law;  // soft, hard, damping, chatter
    for (const Diagnosed& found : findings)
      EXPECT_FALSE(std::regex_search(found.attempt, std::regex("\\b" + law + "\\b"))) << law << ": " << found.attempt;
  }
}

/// A run that a rule might misinterpret, with the right and the wrong advice.
struct Trap {
  const char* rule;
  Scene scene;
  std::vector<std::pair<const char*, double>> metrics;
  /// `right`: text that the advice must contain; if it is empty, the rule must find nothing. `wrong`: text that the
  /// advice must not contain.
  const char *right, *wrong;
  Outcome outcome = Outcome::completes;
  const char* fault = "";
  RunObservations observations = {};
};

RunObservations contact(std::uint64_t saturated = 0) {
  RunObservations rows;
  rows.in_contact = 100;
  rows.at_force_limit = saturated;
  return rows;
}

RunObservations inside() {
  RunObservations rows;
  rows.facts.began_inside = true;
  return rows;
}

RunObservations held() {
  RunObservations rows;
  rows.facts.holding_friction = 0.8;
  return rows;
}

RunObservations pressed() {
  RunObservations rows;
  rows.last_force = {0.0, 0.0, 1.0};
  return rows;
}

RunObservations long_step() {
  RunObservations rows;
  rows.longest_step = 1.0;
  return rows;
}

RunObservations moved_in_last_quarter() {
  RunObservations rows;
  rows.last_quarter.rows = 100;
  rows.last_force = {0.0, 0.0, 1.0};
  rows.tip = {0.01, 0.0, 0.0};
  return rows;
}

RunObservations motors(double created) {
  RunObservations rows;
  rows.created_by_motors = created;
  return rows;
}

/// Returns observations of a tool that a hand presses down with 1 N and pulls along x with 1 N.
RunObservations pulled() {
  RunObservations rows = pressed();
  rows.last_spring = {0.0, 0.0, 1.0};
  rows.last_hand_force = {1.0, 0.0, -1.0};
  return rows;
}

const Scene kMolar = {"drag_molar"}, kOmegaMolar = {"drag_molar", {kOmega}}, kLed = {"recorded_wipe"};
constexpr const char* kMean = "force_mean_in_contact_N";

std::vector<Trap> traps() {
  const std::vector<std::pair<const char*, double>> buzz = {{kMean, 1.0}, {"force_rms_above_30Hz_N", 0.5}};
  const Scene passive = {"peg_in_hole_2d_shaped_stiffness"};  // nothing presses this tool
  const auto sticky = [](const char* mu) {
    return Scene{"poke_plane",
                 {R"(hand={"type":"impedance","target":{"x_m":0.01,"y_m":0,"z_m":-0.01}})",
                  fmt::format(R"(rendering.friction={{"type":"dry","mu":{}}})", mu)}};
  };
  const auto handle_noise = [](const char* noise) {
    return Scene{"tap_wall",
                 {fmt::format("device.position_noise_m={}", noise), "rendering.damping_N_s_per_m=5",
                  R"(device.velocity_filter={"type":"difference"})"}};
  };
  return {
      // If a law fails, the time step is not the cause. If a hand drives the tool away, K is not the cause.
      {"fault", kMolar, {}, "correct the law", "time.step_s", Outcome::diverges, "gives a force that is not finite"},
      {"diverged", kMolar, {}, "without contact", "smaller K", Outcome::diverges},
      {"edge", kMolar, {{"ratio_max", 1e9}}, "", "smaller K", Outcome::diverges, "gives a force that is not finite"},
      // No K helps a tool that starts inside the object. Changing the hand does not help a tool that a script moves.
      {"sank", kMolar, {}, "initial.position_m", "larger K", Outcome::went_through, "", inside()},
      {"sank", kLed, {}, "motion.position", "larger K", Outcome::went_through},
      {"lost", kOmegaMolar, {}, "device.coulomb_N", "initial.position_m", Outcome::no_contact, "", held()},
      {"lost", kLed, {}, "motion.position", "hand's direction", Outcome::no_contact},
      {"stuck", {"impedance_at_wall"}, {}, "device.coulomb_N", "rendering.friction", Outcome::stuck},
      {"stuck", {"drag_molar_dry"}, {}, "rendering.friction", "device.coulomb_N", Outcome::stuck, "", pressed()},
      // Without a rendered force, neither the friction of the surface nor the law holds the tool.
      {"stuck", {"drag_molar_dry"}, {}, "a stiffer hand", "rendering.friction", Outcome::stuck},
      // A hand whose spring acts in all directions presses harder if it is stiffer: 1 N along the surface moves a tool
      // with a normal force of 1 N only if mu is below 1.
      {"stuck", sticky("1.2"), {}, "rendering.friction", "a stiffer hand", Outcome::stuck, "", pulled()},
      {"stuck", sticky("0.8"), {}, "a stiffer hand", "device.coulomb_N", Outcome::stuck, "", pulled()},
      // If the tool diverges, its long steps are a consequence, so the rule `step` finds nothing. A slower hand does
      // not help a tool that a script moves.
      {"step", kMolar, {}, "", "", Outcome::diverges, "", long_step()},
      {"step", kLed, {}, "motion.position", "slower hand", Outcome::completes, "", long_step()},
      // A script makes the same contacts at any K, so a smaller K does not help.
      {"buzz", kLed, buzz, "another algorithm", "smaller K"},
      {"buzz", passive, buzz, "", ""},
      {"pop", passive, {{kMean, 0.05}, {"settled_force_step_max_N", 1.0}}, "", ""},
      {"chatter", passive, {{"force_reversals_per_s", 28.0}}, "", ""},
      {"chatter", kLed, {{"force_reversals_per_s", 28.0}}, "another algorithm", "smaller K"},
      {"shake",
       kMolar,
       {{kMean, 1.0}, {"force_rms_above_30Hz_N", 0.01}, {"vibration_power_above_30Hz_m2_per_s2", 1.0}},
       "",
       ""},
      {"encoder", kOmegaMolar, {{kMean, 1.0}, {"force_rms_above_30Hz_N", 0.01}}, "", ""},
      {"encoder",
       {"drag_molar", {kOmega, R"(device.velocity_filter={"type":"low_pass","cutoff_Hz":1e4})"}},
       buzz,
       "a lower cutoff_Hz",
       "a low-pass"},
      {"deep", kLed, {{"inside_settled_m", 0.1}}, "motion.position", "larger K"},
      {"deep",
       kMolar,
       {{"inside_settled_m", 0.1}},
       "smaller hand force",
       "larger K",
       Outcome::completes,
       "",
       contact(50)},
      // In equilibrium, the rendered force balances the hand's force. A smaller K does not reduce the rendered force.
      {"saturated", kOmegaMolar, {}, "smaller hand force", "smaller K", Outcome::completes, "", contact(50)},
      {"damping",
       {"drag_molar", {"rendering.damping_N_s_per_m=1e4"}},
       {{"ratio_max", 1.0}},
       "rendering.damping_N_s_per_m",
       "zeta"},
      {"damping",
       {"drag_molar", {R"(rendering.damping={"type":"hunt_crossley","chi_s_per_m":1})"}},
       {{"ratio_max", 1e6}},
       "",
       ""},
      // Eight landings are intended, because seven waypoints of tap_wall lift the tool.
      {"bounces", {"tap_wall"}, {{"landings", 8.0}}, "", ""},
      {"bounces", kMolar, {{"landings", 1.0}}, "", ""},
      {"energy",
       {"drag_molar", {"rendering.passivity_controller=true"}},
       {{"passivity.net_created_J", 1.0}},
       "smaller K",
       "passivity_controller"},
      // The rule compares the energy that the motors gave. If they do not apply the rendered force, the delay can be
      // the
      // cause, and the saturation can prevent the creation.
      {"energy", {"tap_wall"}, {{"passivity.net_created_J", 1.0}}, "", "", Outcome::completes, "", motors(0.0)},
      {"energy",
       {"tap_wall", {"device.delay_samples=4"}},
       {{"passivity.net_created_J", 0.0}},
       "a shorter delay",
       "passivity_controller",
       Outcome::completes,
       "",
       motors(2e-3)},
      {"energy",
       {"tap_wall"},
       {{"passivity.net_created_J", 2e-3}},
       "a smaller K",
       "delay",
       Outcome::completes,
       "",
       motors(2e-3)},
      // Noise is a cause if it explains at least half of the vibration of 0.5 N. The noise of a position of 0.1 mm
      // gives
      // B sqrt(2) 0.1 mm / dt = 0.7 N at 1 kHz.
      {"buzz", {"device_at_wall", {"device.sensor.noise_N=1e-9"}}, buzz, "a smaller K", "sensor.noise_N"},
      {"buzz", {"device_at_wall", {"device.sensor.noise_N=100"}}, buzz, "sensor.noise_N", "a smaller K"},
      {"buzz", handle_noise("1e-12"), buzz, "a smaller K", "position_noise_m"},
      {"buzz", handle_noise("1e-4"), buzz, "position_noise_m", "a smaller K"},
      {"drift", {"impedance_at_wall"}, {}, "", "", Outcome::completes, "", moved_in_last_quarter()},
      {"drift",
       {"incline_dry", {"hand.x_N=0.4"}},
       {},
       "a larger rendering.friction.mu",
       "viscous",
       Outcome::completes,
       "",
       moved_in_last_quarter()},
      {"soft", {"single_spring"}, {{"ratio_min", 0.1}}, "shaped_stiffness", "proxy"},
  };
}

TEST(Diagnosis, AdvisesNothingThatIsWrongInTheScene) {
  for (const Trap& trap : traps()) {
    const LoadedScenario loaded = load_scenario(find_scenario(trap.scene.name), trap.scene.overrides);
    Result result;
    result.algorithm = loaded.scenario.rendering.algorithm;
    result.duration = 0.1;
    result.end.outcome = trap.outcome;
    result.end.divergence.fault = trap.fault;
    for (const auto& [name, value] : trap.metrics) result.metrics.push_back({name, "1", "", value});
    const auto tool = make_tool(loaded.scenario, loaded.files);
    const auto all = diagnosis_findings(loaded, result, trap.observations, *tool);
    const auto found = std::ranges::find(all, trap.rule, &Diagnosed::rule);
    const std::string what = std::string(trap.rule) + " in " + trap.scene.name;
    if (std::string_view(trap.right).empty()) {
      EXPECT_EQ(found, all.end()) << what;
      continue;
    }
    ASSERT_NE(found, all.end()) << what;
    EXPECT_NE(found->attempt.find(trap.right), std::string::npos) << what << ": " << found->attempt;
    EXPECT_EQ(found->attempt.find(trap.wrong), std::string::npos) << what << ": " << found->attempt;
  }
}

/// Checks that the advice against an unstable loop is a change after which the loop is stable.
TEST(Diagnosis, AdvisesTheChangeThatMakesALoopStable) {
  // Without any damping, the delay of the hold makes each spring unstable at every time step.
  const Result undamped = run({"wall_on_handle", {"device.viscous_N_s_per_m=0", "rendering.damping_N_s_per_m=0"}});
  const Diagnosed* found = finding(undamped, "loop");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->attempt, "a larger rendering.damping_N_s_per_m");
  EXPECT_EQ(finding(undamped, "edge"), nullptr);
  // With B dt / m = 10 for a handle of 0.1 kg, the damper alone is unstable; a tenth of the step or of B is not enough
  // to reach 2, but a step of a tenth is.
  const Result overdamped = run({"wall_on_handle",
                                 {"device.handle_mass_kg=0.1", "rendering.damping_N_s_per_m=1000",
                                  "rendering.stiffness_N_per_m=1000", "time.step_s=0.001"}});
  found = finding(overdamped, "loop");
  ASSERT_NE(found, nullptr);
  EXPECT_NE(found->attempt.find("a smaller rendering.damping_N_s_per_m"), std::string::npos) << found->attempt;
  EXPECT_EQ(found->attempt.find("a larger"), std::string::npos) << found->attempt;
}

/// Checks that the mass of a passive hand counts for the largest stable damping: 0.03 kg and 0.5 kg bear a damping of
/// 2 m / dt = 1060 N s/m, the handle alone one of 60 N s/m.
TEST(Diagnosis, CountsTheMassOfTheHandForDamping) {
  const Words scene = {R"(device={"type":"impedance","handle_mass_kg":0.03,"viscous_N_s_per_m":0.2})",
                       R"(hand={"type":"mass_spring_damper","mass_kg":0.5,"stiffness_N_per_m":200,
                                "damping_N_s_per_m":3,"target":{"x_m":0,"y_m":0,"z_m":-0.005}})",
                       "time={\"step_s\":0.001,\"duration_s\":1}", "rendering.damping_N_s_per_m=80",
                       "rendering.stiffness_N_per_m=1500"};
  EXPECT_EQ(finding(run({"poke_plane", scene}), "damping"), nullptr);
}

/// Checks a hand whose target jumps sideways 5 ms before the end: a single jump of the force has no frequency.
TEST(Diagnosis, ReportsNoFrequencyOfASingleJump) {
  const Result result = run_of_text(R"({
    "time": {"step_s": 0.001, "duration_s": 2},
    "environment": {"type": "plane", "size_m": 0.04, "spacing_m": 0.0003}, "initial": {"position_m": [0, 0, 0]},
    "tool": {"diameter_m": 0.002, "length_m": 0.02, "tip": "flat"},
    "hand": {"type": "impedance", "stiffness_N_per_m": 200, "damping_N_s_per_m": 5,
             "target": {"x_m": {"type": "waypoints", "points": [[0, 0], [1.995, 0], [1.999, 0.02]],
                                "interpolation": "linear"}, "y_m": 0, "z_m": -0.004}},
    "rendering": {"algorithm": "shaped_stiffness", "stiffness_N_per_m": 20000, "damping_ratio": 0.7}
  })");
  const Diagnosed* const found = finding(result, "buzz");
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->says.find("at about"), std::string::npos) << found->says;
}

/// Checks a handle that friction holds. The target of the hand moves away from the handle by 4.5 mm, so that the hand's
/// spring of 100 N/m pulls with at most 0.45 N. The handle does not move, because its dry friction is 0.8 N.
TEST(Diagnosis, NamesTheFrictionThatHoldsTheHandle) {
  const Result result = run({"impedance_at_wall", {"device.coulomb_N=0.8", "hand.stiffness_N_per_m=100"}});
  ASSERT_EQ(result.end.outcome, Outcome::no_contact);
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings[0].text.find("device.coulomb_N"), std::string::npos) << result.warnings[0].text;
  ASSERT_NE(finding(result, "lost"), nullptr);
  EXPECT_NE(finding(result, "lost")->attempt.find("device.coulomb_N"), std::string::npos);
}

/// Checks a tool that flies past the tooth in a long step: the start position is not the cause.
TEST(Diagnosis, BlamesTheStepWhereThatIsTooLong) {
  const Result leaps = run({"mesh_molar", {"time.step_s=1", "time.steps=5"}});
  ASSERT_NE(finding(leaps, "lost"), nullptr);
  EXPECT_NE(finding(leaps, "lost")->attempt.find("a shorter time.step_s"), std::string::npos);
  ASSERT_FALSE(leaps.warnings.empty());
  EXPECT_NE(leaps.warnings[0].text.find("is time.step_s too long?"), std::string::npos) << leaps.warnings[0].text;

  const Result far = run({"mesh_molar", {"initial.position_m=[0,0,0.1]", "hand.z_N=1.5"}});
  ASSERT_NE(finding(far, "lost"), nullptr);
  EXPECT_NE(finding(far, "lost")->attempt.find("initial.position_m"), std::string::npos);
  EXPECT_EQ(far.warnings[0].text.find("time.step_s"), std::string::npos) << far.warnings[0].text;
}

/// Checks that Diagnose::low_vibration (of `tune`) and Diagnose::everything (of `run`) compare the same numbers with
/// the thresholds: for an impedance device whose motors create energy because of the delay, and for a drill beyond the
/// linear limit of K on a surface.
TEST(Diagnosis, LowVibrationComparesTheSameNumbers) {
  const std::pair<Scene, std::vector<std::string>> scenes[] = {
      {{"tap_wall", {"rendering.stiffness_N_per_m=2000", "rendering.damping_N_s_per_m=2", "device.delay_samples=4"}},
       {"energy"}},
      {{"drag_molar", {"rendering.stiffness_N_per_m=2e6"}}, {"edge"}}};
  for (const auto& [scene, expected] : scenes) {
    const Result diagnosed = run(scene), numbers = run(scene, Diagnose::low_vibration);
    EXPECT_FALSE(numbers.diagnosis);
    std::vector<std::string> beyond;
    for (const Diagnosed& number : numbers.low_vibration) {
      const Diagnosed* const found = finding(diagnosed, number.rule);
      EXPECT_EQ(found != nullptr, number.value > number.threshold) << scene.name << ": " << number.rule;
      if (found == nullptr) continue;
      EXPECT_EQ(found->value, number.value) << scene.name << ": " << number.rule;
      EXPECT_EQ(found->says, number.says);
      beyond.push_back(number.rule);
    }
    for (const Diagnosed& rule : diagnosis_rules(RuleKind::low_vibration))
      EXPECT_EQ(finding(diagnosed, rule.rule) != nullptr, std::ranges::count(beyond, rule.rule) == 1)
          << scene.name << ": " << rule.rule;
    for (const std::string& rule : expected) EXPECT_EQ(std::ranges::count(beyond, rule), 1) << scene.name;
  }
}

/// Checks runs for which no diagnosis is requested. If the numbers of such a run do not characterise the law, the run
/// still has a warning.
TEST(Diagnosis, OfARunThatNobodyDiagnosesIsAWarning) {
  for (const auto& [override, rule] : {std::pair("rendering.friction.mu_f_s_per_m=1000", "friction"),
                                       {R"(rendering.reduction={"threshold":0.9})", "reduction"}}) {
    const Words overrides = {override};
    const char* const scene = rule == std::string_view("friction") ? "drag_molar" : "mesh_molar";
    const Result result = run_scenario(checked(load_scenario(find_scenario(scene), overrides)), std::nullopt, false);
    EXPECT_FALSE(result.diagnosis);
    EXPECT_EQ(std::ranges::count(result.warnings, rule, &Warning::kind), 1) << rule;
  }
}

}  // namespace
}  // namespace hapbench::diagnosis_test
