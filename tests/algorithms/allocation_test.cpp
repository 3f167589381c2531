// Tests that no step allocates heap memory: every algorithm with every stage, on springs and on a shell.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <tuple>

#include "algorithms/depth/depth_model.hpp"
#include "device_model/impedance_device.hpp"
#include "results/summary/allocations.hpp"
#include "sim/core/aligned.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/setting.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::allocation_test {
namespace {

/// Keeps the compiler from removing an unused allocation.
void use(const void* block) {
  asm volatile("" : : "g"(block) : "memory");
}

void free_used(void* block) {
  use(block);
  std::free(block);
}

TEST(AllocationCounter, CountsEveryKindOfAllocation) {
  const struct {
    const char* method;
    void (*allocate)();
    std::uint64_t times;
  } kAllocations[] = {
      {"none", [] {}, 0},
      {"new", [] { use(std::make_unique<int>(1).get()); }, 1},
      {"new[]", [] { use(std::make_unique<int[]>(7).get()); }, 1},
      {"aligned new", [] { use(AlignedDoubles(3).data()); }, 1},
      {"malloc", [] { free_used(std::malloc(10)); }, 1},
      {"calloc", [] { free_used(std::calloc(10, 1)); }, 1},
      {"aligned_alloc", [] { free_used(std::aligned_alloc(64, 64)); }, 1},
      {"Eigen", [] { use(Eigen::MatrixXd(3, 3).data()); }, 1},
  };
  for (const auto& [method, allocate, times] : kAllocations) {
    const AllocationCount count;
    allocate();
    EXPECT_EQ(count.value(), times) << method;
  }
  const AllocationCount count;
  void* block = std::malloc(10);
  use(block);
  free_used(std::realloc(block, 100000));
  EXPECT_GE(count.value(), 2u) << "realloc";
}

struct Stages {
  const char* name;
  bool local_average;
  std::optional<ReductionConfig> reduction;
  bool controlled = false;
  std::optional<MultiRateSchedule> multi_rate = {};
  std::optional<ForceStageConfig> stage = {};
};
const Stages kStages[] = {
    {"plain", false, {}},
    {"reduced", false, ReductionConfig{}},
    {"shuffled_and_reduced", false, ReductionConfig{0.995, 5, 42}},
    {"averaged", true, {}},
    {"averaged_and_reduced", true, ReductionConfig{}},
    {"controlled", false, ReductionConfig{}, true},
    {"held", false, {}, false, MultiRateSchedule{.every = 3, .delay = 0, .dropout = 0.3}},
    {"late_and_linear", false, ReductionConfig{}, true, MultiRateSchedule{.every = 3, .delay = 7, .linear = true}},
    {"with_energy_tank", false, {}, true, {}, EnergyTankConfig{}},
    {"actuator_limited", false, {}, false, {}, ActuatorLimitedPassivityConfig{}},
};

struct Instance {
  std::string_view algorithm;
  std::string_view depth_model;
  const Stages* stages;
  bool springs;

  std::string name() const {
    return std::string(algorithm) + (springs ? "_on_springs_" : "_on_shell_" + std::string(depth_model) + "_") +
           stages->name;
  }
};

void PrintTo(const Instance& instance, std::ostream* out) {
  *out << instance.name();
}

std::vector<Instance> instances() {
  std::vector<Instance> all;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const Stages& stages : kStages) {
      if (!stages.local_average) all.push_back({algorithm.info->name, "surface_normal", &stages, true});
      for (const DepthModelEntry& model : depth_models()) {
        if (!algorithm.fixed_depth_model.empty() && algorithm.fixed_depth_model != model.info->name) continue;
        all.push_back({algorithm.info->name, model.info->name, &stages, false});
      }
    }
  }
  return all;
}

/// Returns bilateral springs in three directions if `instance.springs` is true. Otherwise returns the 2-D peg in a hole
/// of the thesis, with a peg wide enough to touch many points.
test::Setting setting_of(const Instance& instance) {
  test::Setting setting;
  if (instance.springs) {
    setting.springs = SpringSet{{}, true};
    setting.springs->gradients.assign(100, Vec3::UnitX());
    setting.springs->gradients.insert(setting.springs->gradients.end(), 100, -Vec3::UnitX());
    setting.springs->gradients.insert(setting.springs->gradients.end(), 10, -Vec3::UnitY());
    setting.pose.position = {-0.005, -0.005, 0.0};
  } else {
    setting.tool = {0.0005, 0.005, Tip::round};
    setting.points = surface_points(Hole2d{});
    setting.cell_size = 0.0003;
  }
  return setting;
}

SimulationParts parts_of(const Instance& instance, const RenderingConfig& config) {
  const test::Setting setting = setting_of(instance);
  SimulationParts parts = test::free_run(setting, config);
  if (!instance.springs) {
    // The motion is scripted, because some laws would push the peg out of the hole.
    parts.motion = std::make_unique<ScriptedMotion>(
        Orientation{{0, 1, 0}, {1, 0, 0}, Profile::Shape(Profile::Ramp{0.1, 1.2}), {}},
        std::array<Profile, 3>{Profile::Shape(Profile::Sine{0.0, 0.0001, 0.05, 0.0}), -0.004, 0.0});
  }
  return parts;
}

/// Counts steps with contact. Requests the stiffness ratio, so that each step computes the ratio.
class ContactCounter final : public Observer {
 public:
  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override { rows_with_contact += record.colliding > 0; }
  int rows_with_contact = 0;
};

/// Returns the number of allocations in a run, a reset and a second run. The allocations of the construction do not
/// count.
std::uint64_t allocations_of_two_runs(Simulation& simulation) {
  const AllocationCount count;
  simulation.run();
  simulation.reset();
  simulation.run();
  return count.value();
}

class NoAllocation : public testing::TestWithParam<Instance> {};
INSTANTIATE_TEST_SUITE_P(Every, NoAllocation, testing::ValuesIn(instances()),
                         [](const auto& instance) { return instance.param.name(); });

TEST_P(NoAllocation, InAStepOrAReset) {
  RenderingConfig config;
  config.algorithm = GetParam().algorithm;
  config.depth_model = GetParam().depth_model;
  config.local_average = GetParam().stages->local_average;
  config.reduction = GetParam().stages->reduction;
  config.passivity_controller = GetParam().stages->controlled;
  config.multi_rate = GetParam().stages->multi_rate;
  config.force_stage = GetParam().stages->stage;
  config.mu_s = 5.0;
  config.mu_f = 10.0;
  config.angular_damping = true;
  config.max_damping = 100.0;
  config.max_force = 30.0;
  ContactCounter observer;
  const SimulationConfig run = test::free_run_config(setting_of(GetParam()), config, 300);
  Simulation simulation(run, parts_of(GetParam(), config), {&observer});

  EXPECT_EQ(allocations_of_two_runs(simulation), 0u);
  EXPECT_EQ(observer.rows_with_contact, 600 - (config.multi_rate ? 2 * config.multi_rate->delay : 0));
}

/// Checks every algorithm with every integrator, because some integrators find contacts and render again within a step.
class NoAllocationOf : public testing::TestWithParam<std::tuple<AlgorithmEntry, const IntegratorEntry*>> {};
INSTANTIATE_TEST_SUITE_P(Every, NoAllocationOf,
                         testing::Combine(testing::ValuesIn(algorithms().begin(), algorithms().end()),
                                          testing::ValuesIn(kIntegrators)),
                         [](const auto& instance) {
                           return std::string(std::get<AlgorithmEntry>(instance.param).info->name) + "_" +
                                  std::get<const IntegratorEntry*>(instance.param)->info.name;
                         });

TEST_P(NoAllocationOf, AnIntegrator) {
  const auto& [algorithm, integrator] = GetParam();
  for (const bool springs : {false, true}) {
    const Instance instance{algorithm.info->name, "surface_normal", &kStages[1], springs};
    RenderingConfig config;
    config.algorithm = instance.algorithm;
    config.dry_friction = DryFrictionConfig{};
    config.hunt_crossley = 1.0;
    config.reduction = instance.stages->reduction;
    config.mu_s = 5.0;
    config.mu_f = 10.0;
    const test::Setting setting = setting_of(instance);
    SimulationConfig run = test::free_run_config(setting, config, 300);
    run.integrator = integrator;
    if (!springs) run.position = {0.0002, -0.004, 0.0};
    ContactCounter observer;
    Simulation simulation(run, test::free_run(setting, config), {&observer});
    EXPECT_EQ(allocations_of_two_runs(simulation), 0u);
    EXPECT_GT(observer.rows_with_contact, 0);
  }
}

TEST(NoAllocationInAStep, OfAnImpedanceDevice) {
  const Instance instance{"shaped_stiffness", "surface_normal", &kStages[1], false};
  const RenderingConfig config;
  ImpedanceDeviceConfig device{.handle_mass = 0.1,
                               .viscous = 0.5,
                               .coulomb = 0.05,
                               .encoder_step = 1e-5,
                               .delay_samples = 2.4,
                               .velocity_filter = {},
                               .force_max = 2.0,
                               .force_step = 0.01,
                               .force_slew = 1000.0,
                               .position_filter = LowPassFilter{200.0, 3},
                               .position_noise = 1e-6,
                               .transmission = {}};
  for (const VelocityFilterConfig& filter :
       {VelocityFilterConfig(DifferenceFilter{}), VelocityFilterConfig(LowPassFilter{100.0, 4}),
        VelocityFilterConfig(AdaptiveWindowFilter{})}) {
    device.velocity_filter = filter;
    if (std::holds_alternative<AdaptiveWindowFilter>(filter)) device.transmission = Transmission{0.5, 1e4, 1.0};
    const test::Setting setting = setting_of(instance);
    SimulationConfig run = test::free_run_config(setting, config, 300);
    run.position = {0.0002, -0.004, 0.0};
    SimulationParts parts = test::free_run(setting, config);
    parts.device = std::make_unique<ImpedanceDevice>(device, run.dt, AttachedHand{0.1, 300.0, 6.0});
    ContactCounter observer;
    Simulation simulation(run, std::move(parts), {&observer});
    EXPECT_EQ(allocations_of_two_runs(simulation), 0u);
    EXPECT_GT(observer.rows_with_contact, 0);
  }
}

class NoAllocationWith : public testing::TestWithParam<test::ToolKind> {};
INSTANTIATE_TEST_SUITE_P(Every, NoAllocationWith,
                         testing::ValuesIn(test::tool_kinds().begin(), test::tool_kinds().end()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(NoAllocationWith, ATool) {
  for (const char* algorithm : {"summation", "proxy", "normal_projection"}) {
    for (const DepthModelEntry& model : depth_models()) {
      RenderingConfig config;
      config.algorithm = algorithm;
      config.depth_model = model.info->name;
      if (algorithm == std::string_view("normal_projection") && config.depth_model != algorithm) continue;
      const Instance instance{algorithm, config.depth_model, &kStages[0], false};
      Random random(1);
      SimulationParts parts = parts_of(instance, config);
      parts.tool = GetParam().make(random, 0.01).shape;  // wider than the hole, which is 1 mm wide
      parts.source = std::make_unique<ShellSource>(*parts.shell, *parts.tool,
                                                   make_contact_query(*parts.shell, *parts.tool, Skips::on),
                                                   make_depth_model(config));
      ContactCounter observer;
      Simulation simulation(test::free_run_config(setting_of(instance), config, 300), std::move(parts), {&observer});
      EXPECT_EQ(allocations_of_two_runs(simulation), 0u);
      EXPECT_GT(observer.rows_with_contact, 0);
    }
  }
}

}  // namespace
}  // namespace hapbench::allocation_test
