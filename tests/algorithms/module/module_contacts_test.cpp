#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "algorithms/module/module.hpp"
#include "algorithms/registry.hpp"
#include "tests/support/fakes.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::module_contacts_test {
namespace {

constexpr double kLength = 0.01;

struct Contact {
  std::uint32_t index;
  Vec3 point, gradient;
  double depth;
};

struct Script {
  std::vector<Contact> answer;
  std::size_t more = 0;  ///< number of contacts that are reported but not written
  int asked = 0;
  int throws_at = -1;
  HapbenchPose pose = {};
};
Script script;

/// Step function of the module under test. Throws at call number `script.throws_at`, counted from 0. At all other
/// calls, writes the contacts `script.answer`.
int step(void*, const HapbenchPose* pose, HapbenchContacts* contacts, HapbenchForce*, char*) {
  script.pose = *pose;
  if (script.asked++ == script.throws_at) throw std::runtime_error("no\nway");
  for (std::size_t i = 0; i < script.answer.size(); ++i) {
    const auto& [index, point, gradient, depth] = script.answer[i];
    contacts->index[i] = index;
    contacts->depth[i] = depth;
    contacts->gx[i] = gradient.x(), contacts->gy[i] = gradient.y(), contacts->gz[i] = gradient.z();
    contacts->x[i] = point.x(), contacts->y[i] = point.y(), contacts->z[i] = point.z();
  }
  contacts->n = script.answer.size() + script.more;
  return 0;
}

std::unique_ptr<ModuleContacts> source_of(Script what) {
  script = std::move(what);
  auto table = std::make_shared<HapbenchModule>();
  table->version = HAPBENCH_MODULE_VERSION;
  table->kind = HAPBENCH_CONTACTS;
  table->name = "fake";
  table->step = step;
  HapbenchRun run = {};
  run.capacity = 10;
  run.tool_length = kLength;
  return std::make_unique<ModuleContacts>(Module{table, "file.so"}, "{}", run);
}

TEST(ModuleContacts, AsksAboutTheMiddleOfTheDrillWithItsShankAlongZ) {
  const auto source = source_of({});
  ContactBuffer contacts(source->capacity());
  const Vec3 axis = Vec3(1, 2, -3).normalized();
  source->contacts_at({{0.1, 0.2, 0.3}, axis}, contacts);
  const auto& [tip, centre, r] = script.pose;
  EXPECT_EQ(Vec3::Map(tip), Vec3(0.1, 0.2, 0.3));
  EXPECT_TRUE(Vec3(centre[0], centre[1], centre[2]).isApprox(Vec3(0.1, 0.2, 0.3) - 0.5 * kLength * axis, 1e-15));
  EXPECT_TRUE(Vec3(r[2], r[5], r[8]).isApprox(-axis, 1e-15));
}

TEST(ModuleContacts, ThatCannotBeUsedAreRefused) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto source = source_of({});
  const auto fault_of = [&](const Contact& contact, std::size_t more = 0) -> std::string {
    script.answer = {contact}, script.more = more;
    ContactBuffer contacts(source->capacity());
    source->reset();
    source->contacts_at({}, contacts);
    EXPECT_EQ(contacts.size(), source->fault() == nullptr ? 1u : 0u);
    const std::string fault = source->fault() == nullptr ? "" : source->fault(), start = "fake (file.so) gives ";
    EXPECT_TRUE(fault.empty() || fault.starts_with(start)) << fault;
    return fault.empty() ? "" : fault.substr(start.size());
  };
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, 0.0}), "");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1.0009}, 1.0}), "");
  EXPECT_EQ(fault_of({0, {1, 2, kInfinity}, {0, 0, -1}, 1.0}), "a contact that is not finite");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -kInfinity}, 1.0}), "a contact that is not finite");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, kInfinity}), "a contact that is not finite");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1.002}, 1.0}), "a contact whose gradient is not a unit vector");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, 0}, 1.0}), "a contact whose gradient is not a unit vector");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, -1e-9}), "a contact with a negative depth");
  EXPECT_EQ(fault_of({0, {1, 2, 3}, {0, 0, -1}, 1.0}, 10), "11 contacts; allowed: at most 10");
}

TEST(ModuleContacts, EndTheRunWhenTheModuleThrows) {
  take_module_faults();
  for (const AlgorithmEntry& algorithm : algorithms()) {
    for (const bool controlled : {false, true}) {
      test::Setting setting;
      setting.springs.emplace();
      RenderingConfig config;
      config.algorithm = algorithm.info->name;
      config.passivity_controller = controlled;
      config.max_force = 1.0;
      config.reduction.emplace();
      SimulationParts parts = test::free_run(setting, config);
      parts.source = source_of({.answer = {{0, {}, {0, 0, -1}, 1e-5}, {1, {}, {1, 0, 0}, 1e-5}}, .throws_at = 3});
      Simulation simulation(test::free_run_config(setting, config, 10), std::move(parts), {});
      const SimulationResult result = simulation.run();
      EXPECT_EQ(result.ending, Ending::diverged) << algorithm.info->name << controlled;
      EXPECT_EQ(result.divergence.step, 3u);
      EXPECT_EQ(result.divergence.fault, "fake (file.so) throws in step: no?way");
      EXPECT_EQ(script.asked, 4);
      EXPECT_EQ(take_module_faults().count, 1u);
      simulation.reset();
      script.throws_at = -1;
      EXPECT_EQ(simulation.run().ending, Ending::completed);
    }
  }
}

}  // namespace
}  // namespace hapbench::module_contacts_test
