#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/bundled.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::run_scenario_test {
namespace {

namespace fs = std::filesystem;
using test::TemporaryDirectory;

// Tests a run with its trials and files, and the ways in which it ends: complete, diverged or stopped.

/// Returns the scenario of a study of two subjects, with two trials of two targets each, on a plane. Its run takes
/// little time.
LoadedScenario study(const char* record = R"({"trajectory": false})") {
  const Json json = Json::parse(std::string(R"({
    "name": "study", "time": {"step_s": 0.001, "duration_s": 30}, "environment": {"type": "plane", "size_m": 0.004},
    "hand": {"type": "tracking", "subjects": [{}, {"press_N": 1.5}], "trials": 2,
             "task": {"places_m": [[0.0005, 0, 0], [-0.0005, 0, 0]], "targets_per_place": 1}},
    "device": {"type": "admittance", "sensor": {"noise_N": 0.01}},
    "record": )") + record + "}");
  return read_scenario(json, ".");
}

TEST(Trials, EverySubjectDoesEveryTrialOnceAndDifferently) {
  const Result report = run_scenario(checked(study(R"({"trajectory": false, "timing": true})")), std::nullopt, false);
  ASSERT_EQ(report.targets.size(), 8u);
  std::set<std::pair<std::size_t, std::size_t>> trials;
  std::set<double> forces;
  for (const TargetRow& row : report.targets) {
    trials.insert({row.subject, row.trial});
    forces.insert(row.model_force);
  }
  EXPECT_EQ(trials, (std::set<std::pair<std::size_t, std::size_t>>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  EXPECT_EQ(forces.size(), 8u) << "no two targets were met alike";
  EXPECT_EQ(report.end.outcome, Outcome::completes);
  EXPECT_EQ(report.timing.latency->steps, report.end.rows);
  EXPECT_EQ(report.state_hash, run_scenario(checked(study()), std::nullopt, false).state_hash)
      << "another run repeats them";
}

TEST(Trials, RecordsOfSeveralTrialsLieInDirectoriesOfTheirOwn) {
  const TemporaryDirectory dir;
  EXPECT_EQ(
      run_scenario(checked(study(R"({"trajectory": true, "energy": true})")), dir / "out", false).work.allocations, 0u);
  for (const char* trial : {"subject_0_trial_0", "subject_0_trial_1", "subject_1_trial_0", "subject_1_trial_1"}) {
    EXPECT_TRUE(fs::exists(dir / "out" / trial / "trajectory.csv")) << trial;
    EXPECT_TRUE(fs::exists(dir / "out" / trial / "energy.csv")) << trial;
  }
  EXPECT_TRUE(fs::exists(dir / "out" / "targets.csv"));
  EXPECT_FALSE(fs::exists(dir / "out" / "trajectory.csv"));
  EXPECT_EQ(test::lines_of(test::read_file(dir / "out" / "targets.csv")).size(), 9u);

  run_scenario(checked(study()), dir / "out", false);
  EXPECT_FALSE(fs::exists(dir / "out" / "subject_0_trial_0")) << "of the earlier run";
  EXPECT_TRUE(fs::exists(dir / "out" / "targets.csv"));
}

LoadedScenario springs(const char* record) {
  Json json = Json::parse(
      R"({"environment": {"type": "springs", "groups": [{"direction": [1, 2, 3], "count": 1},
        {"direction": [1, 0, 0], "count": 2}]},
                              "initial": {"position_m": [0.001, 0.002, 0.0005]}})");
  json["time"] = {{"step_s", 0.0005}, {"steps", 2000}};
  json["record"] = Json::parse(record);
  return read_scenario(json, ".");
}

TEST(ExpectedOutput, IsWithinAFactorOfTwoOfWhatIsWritten) {
  for (const char* record :
       {R"({"trajectory": true, "every": 3})", R"({"trajectory": false, "energy": true, "stiffness_tensor": true})",
        R"({"trajectory": false, "ratio_iterations": [0, 1, 3]})"}) {
    const test::TemporaryDirectory directory;
    const LoadedScenario loaded = springs(record);
    run_scenario(checked(loaded), directory.path(), false);
    double written = 0.0;
    for (const auto& entry : std::filesystem::directory_iterator(directory.path())) {
      if (entry.path().extension() == ".csv") written += static_cast<double>(entry.file_size());
    }
    const double expected = expected_output_bytes(loaded.scenario);
    EXPECT_LT(expected, 2.0 * written) << record;
    EXPECT_GT(expected, 0.5 * written) << record;
  }
}

/// Checks a hand whose damping is too large for the time step. The handle, which is a separate body, diverges, while
/// the tool continues to oscillate.
TEST(Divergence, OfTheHandleEndsTheRun) {
  const Json scenario = Json::parse(R"({
    "time": {"step_s": 0.003, "steps": 2000},
    "environment": {"type": "plane"},
    "initial": {"position_m": [0, 0, 0]},
    "device": {"type": "admittance"},
    "hand": {"type": "impedance", "stiffness_N_per_m": 500, "damping_N_s_per_m": 50,
             "target": {"x_m": 0, "y_m": 0, "z_m": -0.001}}
  })");
  const Result run = run_scenario(checked(read_scenario(scenario, ".")), std::nullopt, false);
  EXPECT_EQ(run.end.outcome, Outcome::diverges);
  const std::string quantity = run.end.divergence.quantity;
  EXPECT_TRUE(quantity == "handle position" || quantity == "handle velocity" || quantity == "measured force")
      << quantity;
  EXPECT_GT(run.end.divergence.magnitude, run.end.divergence.bound);
}

/// Fixture that gives SIGINT its default action, as in a process that a shell starts in the foreground. A process that
/// a shell starts with "&" ignores SIGINT.
class StopSignals : public testing::Test {
 protected:
  StopSignals() : before_(std::signal(SIGINT, SIG_DFL)) {}
  ~StopSignals() override { std::signal(SIGINT, before_); }

 private:
  void (*before_)(int);
};

TEST_F(StopSignals, EndARunOfWhichNothingIsLeft) {
  const test::TemporaryDirectory directory;
  LoadedScenario loaded = read_scenario(test::minimal_scenario("springs"), ".");
  for (const bool timed : {false, true}) {
    loaded.scenario.record.timing = timed;
    const StopSignal signals;
    std::raise(SIGINT);
    EXPECT_THROW(run_scenario(checked(loaded), directory / "out/below", false), Stopped);
    EXPECT_EQ(directory.entries(), std::vector<std::string>{});
  }
  run_scenario(checked(loaded), directory / "out/below", false);
  EXPECT_TRUE(std::filesystem::exists(directory / "out/below/summary.json"));
}

// Compares the linear model of the loop of hand, device and contact with the simulation of the same scenario.

Scenario single_spring(const std::vector<std::string>& overrides = {}) {
  return test::bundled("single_spring", overrides);
}

TEST(StiffnessEigenvalues, AreThoseOfTheSpringsUnderTheAlgorithm) {
  const struct {
    const char *groups, *algorithm;
    double lambda;
  } kCases[] = {
      {R"([{"direction":[1,0,0],"count":7},{"direction":[0,-1,0],"count":3}])", "summation", 7.0},
      // Three springs in a plane, at angles of 60 degrees, have the stiffness matrix 3/2 K I in this plane.
      {R"([{"direction":[1,0,0],"count":1},{"direction":[0.5,0.8660254037844386,0],"count":1},
           {"direction":[-0.5,0.8660254037844386,0],"count":1}])",
       "summation", 1.5},
      {R"([{"direction":[1,0,0],"count":10},{"direction":[-1,0,0],"count":10}])", "shaped_stiffness", 1.0},
      {R"([{"direction":[1,0,0],"count":4}])", "virtual_coupling", 0.8},  // in series: 1 / (1 + 1 / 4)
  };
  for (const auto& c : kCases) {
    const Scenario scenario = single_spring(
        {std::string("environment.groups=") + c.groups, std::string("rendering.algorithm=") + c.algorithm});
    EXPECT_NEAR(stiffness_eigenvalues(scenario)[2], c.lambda, 1e-12) << c.algorithm << " " << c.groups;
  }
}

TEST(SpringsStay, OnlyWhereTheyDo) {
  EXPECT_TRUE(has_permanent_springs(single_spring()));
  for (const char* override :
       {R"(environment={"type":"plane"})", "environment.bilateral=false", "environment.signed=false",
        "rendering.friction.mu_s_N_s_per_m=1", "rendering.friction.mu_f_s_per_m=1",
        "rendering.limits.max_damping_N_s_per_m=1", "rendering.limits.max_force_N=1",
        "rendering.passivity_controller=true", R"(motion={"position":{"type":"prescribed","x_m":0,"y_m":0,"z_m":0}})"})
    EXPECT_FALSE(has_permanent_springs(single_spring({override}))) << override;
}

Scenario struck(Scenario scenario) {
  scenario.time.steps = 60;
  scenario.initial.velocity.x() = 0.02;
  return scenario;
}

Scenario wall_on_handle(double delay, double K) {
  const std::vector<std::string> overrides = {fmt::format("device.delay_samples={}", delay),
                                              fmt::format("rendering.stiffness_N_per_m={}", K)};
  return struck(test::bundled("wall_on_handle", overrides));
}

/// Returns the scenario of a hand on the admittance device, at a two-sided wall.
Scenario admittance_on_wall(double delay) {
  Scenario scenario = test::bundled("single_spring");
  ImpedanceHandFields hand;
  hand.stiffness = 2000.0;
  scenario.hand = hand;
  AdmittanceDeviceConfig device;
  device.servo.delay = static_cast<std::size_t>(delay);
  scenario.device = device;
  return struck(scenario);
}

/// Rounding error of the state after up to 60 steps, relative to the largest state so far. The state need not decay.
constexpr double kRounding = 1e-12;

void expect_same_motion(const Scenario& scenario) {
  const Eigen::MatrixXd A = device_loop(scenario, 1.0).state_matrix();
  const double T = scenario.time.step, x = scenario.initial.position.x();
  Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
  state.head(3) << x, T * scenario.initial.velocity.x(), x;  // the filter starts at rest
  const std::vector<StepRecord> rows = test::rows_of(scenario);
  double scale = state.norm();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    scale = std::max(scale, state.norm());
    ASSERT_NEAR(rows[k].tool.pose.position.x(), state[0], kRounding * scale) << k;
    ASSERT_NEAR(rows[k].handle.position.x(), state[0], kRounding * scale) << k;
    ASSERT_NEAR(rows[k].handle.velocity.x() * T, state[1], kRounding * scale) << k;
    state = A * state;
  }
}

TEST(DeviceLoop, OfAnImpedanceDeviceIsTheSimulationsLinearMap) {
  Random random(1);
  for (const double delay : {0.0, 0.25, 1.0, 2.5}) {
    for (const bool filtered : {false, true}) {
      for (const bool held : {false, true}) {
        Scenario scenario = wall_on_handle(delay, 5000.0 * random.uniform());
        auto& device = std::get<ImpedanceDeviceConfig>(scenario.device);
        device.viscous = random.uniform();
        device.handle_mass = 0.05 + random.uniform();
        if (filtered) device.velocity_filter = LowPassFilter{200.0 * random.uniform()};
        if (held) {
          MassSpringDamperHandFields hand;
          hand.mass = random.uniform();
          hand.spring = {1000.0 * random.uniform(), 10.0 * random.uniform(), {}, {}};
          scenario.hand = hand;
        }
        SCOPED_TRACE(testing::Message() << delay << " " << filtered << " " << held);
        expect_same_motion(scenario);
      }
    }
  }
}

TEST(DeviceLoop, OfTheAdmittanceDeviceIsTheSimulationsLinearMap) {
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double delay : {0.0, 1.0, 3.0}) {
      Scenario scenario = admittance_on_wall(delay);
      auto& device = std::get<AdmittanceDeviceConfig>(scenario.device);
      device.force_limit.reset();
      device.servo.max_force = 1e9;
      scenario.integrator.type = integrator;
      scenario.initial.position.x() = 1e-3;
      const Eigen::MatrixXd A = device_loop(scenario, 1.0).state_matrix();
      const double x = 1e-3, Tv = scenario.time.step * 0.02;
      Eigen::VectorXd state = Eigen::VectorXd::Zero(A.rows());
      state.head(6) << x, Tv, x, Tv, x, Tv;
      const std::vector<StepRecord> rows = test::rows_of(scenario);
      double scale = state.norm();
      for (std::size_t k = 0; k < rows.size(); ++k) {
        scale = std::max(scale, state.norm());
        ASSERT_NEAR(rows[k].tool.pose.position.x(), state[0], kRounding * scale) << integrator->info.name << " " << k;
        ASSERT_NEAR(rows[k].handle.position.x(), state[4], kRounding * scale) << integrator->info.name << " " << k;
        state = A * state;
      }
    }
  }
}

TEST(DeviceLoop, NamesWhatIsNotLinear) {
  const Scenario linear = wall_on_handle(0.0, 1000.0);
  EXPECT_EQ(device_loop(linear, 1.0).no_theory, "");
  Scenario scenario = linear;
  std::get<ImpedanceDeviceConfig>(scenario.device).velocity_filter = AdaptiveWindowFilter{};
  EXPECT_NE(device_loop(scenario, 1.0).no_theory, "");
  scenario = linear;
  scenario.hand = ImpedanceHandFields{};
  EXPECT_EQ(device_loop(scenario, 1.0).no_theory, "") << "the loop contains a sampled hand";
  Scenario dry = linear;
  std::get<ImpedanceDeviceConfig>(dry.device).coulomb = 0.02;
  EXPECT_NE(device_loop(dry, 1.0).no_theory, "");
}

/// Checks that a virtual mass M with an undamped bristle is stable up to K_t = 4 M / dt^2.
TEST(ContactLoops, HaveThatOfAToolHeldByFriction) {
  for (const double factor : {0.99, 1.01}) {
    Scenario scenario = test::bundled("drag_molar_dry");
    scenario.hand = NoHandFields{};  // the loop would contain the spring of the hand
    const double limit = 4.0 * scenario.rendering.mass / (scenario.time.step * scenario.time.step);
    scenario.rendering.dry_friction = DryFrictionConfig{0.3, factor * limit, 0.0};
    LinearContact contact;
    contact.rendered.stiffness = Vec3(0.0, 0.0, scenario.rendering.stiffness).asDiagonal();
    contact.rendered.assumed.stiffness = contact.rendered.stiffness;
    const std::vector<NamedLoop> loops = contact_loops(scenario, contact, false);
    ASSERT_EQ(loops.size(), 2u);
    EXPECT_TRUE(is_stable_loop(loops[0].matrices));
    EXPECT_EQ(loops[1].name, "the tool held by friction");
    EXPECT_EQ(is_stable_loop(loops[1].matrices), factor < 1.0);
  }
}

/// Checks that an experiment is stable only if the loop of every subject is, on every device. A hand whose damping is
/// above 2 M / dt is unstable, because its force is held over a step; M: the virtual mass, or the mass of the handle.
TEST(ContactLoops, HaveThatOfEverySubject) {
  Scenario scenario = test::bundled("vertical_peg_in_hole_shaped_stiffness");
  scenario.rendering.damping = 0.0;
  Subject gentle, rigid;
  rigid.damping = 1.1 * 2.0 * scenario.rendering.mass / scenario.time.step;
  ImpedanceDeviceConfig handle;
  handle.handle_mass = scenario.rendering.mass;
  handle.viscous = 10.0;  // without friction and contact damping, the held spring of the gentle hand would be unstable
  auto& subjects = std::get<TrackingHandFields>(scenario.hand).subjects;
  for (const DeviceFields& device :
       {DeviceFields(IdealDeviceFields{}), DeviceFields(handle), DeviceFields(AdmittanceDeviceConfig{})}) {
    scenario.device = device;
    for (const auto& [with, stable] : {std::pair(std::vector{gentle, gentle}, true),
                                       {std::vector{gentle, rigid}, false},
                                       {std::vector{rigid, gentle}, false}}) {
      subjects = with;
      LinearContact contact;
      contact.rendered.stiffness = Vec3(0.0, 0.0, 1000.0).asDiagonal();
      contact.rendered.damping = Vec3(0.0, 0.0, 10.0).asDiagonal();
      contact.rendered.assumed = {contact.rendered.stiffness, contact.rendered.damping};
      contact.hand = {with[0].stiffness * Mat3::Identity(), with[0].damping * Mat3::Identity()};
      EXPECT_EQ(is_stable_loop(contact_loop(scenario, contact)), stable) << device.index();
      EXPECT_EQ(unstable_without_wall(scenario).empty(), stable) << device.index();
      EXPECT_EQ(contact_step_matrices(scenario, 0.0).size(), stable ? 1u : 2u) << "equal hands have one loop";
    }
  }
}

TEST(DeviceLoop, KnowsEveryFieldOfTheDevices) {
  Scenario scenario;
  const LowPassFilter filter{50.0, 3};
  for (const VelocityFilterConfig& velocity :
       {VelocityFilterConfig(filter), VelocityFilterConfig(AdaptiveWindowFilter{2e-5})}) {
    scenario.device = ImpedanceDeviceConfig{0.1, 0.2,  0.3,   1e-5,   1.5,  1.5e-3, velocity,
                                            5.0, 0.01, 100.0, filter, 1e-6, 9,      Transmission{0.3, 2000.0, 2.0}};
    EXPECT_EQ(unmodelled_fields(scenario), "");
  }
  scenario.device = AdmittanceDeviceConfig{
      {1.0, Vec3::UnitX(), false, 0.1, 7}, 3.0, {1e4, 100.0, 20.0, 3}, {1.0, 2.0, 3.0, 4.0, 5.0}};
  EXPECT_EQ(unmodelled_fields(scenario), "");
}

}  // namespace
}  // namespace hapbench::run_scenario_test
