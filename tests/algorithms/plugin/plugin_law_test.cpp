#include <gtest/gtest.h>

#include <bit>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <limits>
#include <stdexcept>
#include <thread>

#include "algorithms/penalty_rendering.hpp"
#include "algorithms/plugin/law_plugin.hpp"
#include "algorithms/plugin/plugin_call.hpp"
#include "algorithms/plugin/plugin_law.hpp"
#include "algorithms/registry.hpp"
#include "results/allocations/allocations.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::plugin_law_test {
namespace {

std::unique_ptr<ForceAlgorithm> make_some(const RenderingConfig& config) {
  return std::make_unique<PenaltyRendering>(make_law("mean", config), config);
}

/// Adds an algorithm and returns the reason of a refusal, or nothing.
std::string problem_with(const ModelInfo& info, std::vector<OwnParameter> parameters = {}) {
  try {
    add_algorithm({.info = &info, .make = make_some, .own_parameters = parameters});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(AddedAlgorithm, IsFoundAndCanBeReplaced) {
  const std::size_t before = algorithms().size(), additions_before = additions();
  const AlgorithmEntry& mean = *find_algorithm("mean");
  {
    // Temporary texts, which are copied.
    std::string name = "added", text = "text", parameter = "gain";
    const OwnParameter own[] = {{parameter.c_str(), {0, 2, "1"}, 0.5, text.c_str()}};
    const ModelInfo info{name.c_str(), text.c_str(), text.c_str(), text.c_str(), text.c_str()};
    add_algorithm({.info = &info, .make = make_some, .own_parameters = own});
    name = text = parameter = "other";
  }
  ASSERT_EQ(algorithms().size(), before + 1);
  EXPECT_EQ(algorithm_names().back(), "added");
  EXPECT_EQ(&mean, find_algorithm("mean"));
  const AlgorithmEntry& added = *find_algorithm("added");
  EXPECT_STREQ(added.info->summary, "text");
  RenderingConfig config;
  config.algorithm = "added";
  EXPECT_NE(make_algorithm(config), nullptr);
  EXPECT_EQ(own_values(config, added), std::vector<double>{0.5});
  config.parameters["added"]["gain"] = 2.0;
  EXPECT_EQ(own_values(config, added), std::vector<double>{2.0});

  EXPECT_EQ(problem_with({"added", "again", "a", "b", "c"}), "");
  EXPECT_EQ(algorithms().size(), before + 1);
  EXPECT_EQ(&added, find_algorithm("added"));
  EXPECT_STREQ(added.info->summary, "again");
  EXPECT_EQ(additions(), additions_before + 2);
}

TEST(AddedAlgorithm, IsRefusedWithTheReason) {
  const std::size_t before = algorithms().size();
  const auto named = [](const char* name) { return problem_with({name, "a", "b", "c", "d"}); };
  EXPECT_EQ(named("mean"), "\"mean\" is the name of a built-in algorithm");
  EXPECT_EQ(named("all"), "an algorithm is called \"all\", which means all of them");
  for (const char* name : {"", "a.b", "A", "1st", "with blank", "a,b", "a=b"})
    EXPECT_TRUE(named(name).starts_with("an algorithm is called \"" + std::string(name) + "\"; allowed: letters"));
  EXPECT_TRUE(named(nullptr).starts_with("an algorithm is called \"\""));
  EXPECT_EQ(problem_with({"x", nullptr, "b", "c", "d"}), "its summary is missing");
  EXPECT_EQ(problem_with({"x", "a", "", "c", "d"}), "its formula is missing");
  EXPECT_EQ(problem_with({"x", "a", "b", nullptr, "d"}), "its source is missing");
  EXPECT_EQ(problem_with({"x", "a", "b", "c", nullptr}), "its known failure is missing");

  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto with = [](std::vector<OwnParameter> own) {
    return problem_with({"x", "a", "b", "c", "d"}, std::move(own));
  };
  const OwnParameter good{"p", {0, 1, "1"}, 0.5, "meaning"};
  EXPECT_EQ(with({good, good}), "parameter \"p\" is there twice");
  EXPECT_TRUE(with({{"a b", good.range, 0.5, "m"}}).starts_with("a parameter is called \"a b\"; allowed"));
  EXPECT_EQ(with({{"p", good.range, 1.5, "m"}}), "parameter \"p\": its default is out of its range");
  EXPECT_EQ(with({{"p", {0, 1, "1", true}, 0.0, "m"}}), "parameter \"p\": its default is out of its range");
  EXPECT_EQ(with({{"p", good.range, std::numeric_limits<double>::quiet_NaN(), "m"}}),
            "parameter \"p\": its default is out of its range");
  for (const NumberRange range : {NumberRange{1, 0, "1"}, {1, 1, "1"}, {0, kInfinity, "1"}})
    EXPECT_EQ(with({{"p", range, 0.5, "m"}}), "parameter \"p\": a range needs two finite ends, the lower first");
  EXPECT_EQ(with({{"p", {0, 1, nullptr}, 0.5, "m"}}), "parameter \"p\": its unit is missing");
  EXPECT_EQ(with({{"p", good.range, 0.5, nullptr}}), "parameter \"p\": its meaning is missing");
  EXPECT_EQ(algorithms().size(), before);
}

constexpr double kK = 20000.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const Vec3 kTip(0.1, -0.2, 0.3);

/// The behaviour of the plugins below, and counts of their calls.
struct Script {
  int error = 0;
  double weight_scale = 1.0;
  std::size_t weights_forgotten = 0;
  double force = -1.0;
  double stiffness = 0.5;
  bool creates = true;
  int evaluated = 0, reset = 0, destroyed = 0;
};
Script script;

void* create(const double*, double, std::size_t) {
  return script.creates ? &script : nullptr;
}

int mean(void*, const HapbenchContacts* contacts, double* weights, HapbenchForce*) {
  ++script.evaluated;
  const double c = script.weight_scale / static_cast<double>(contacts->n);
  for (std::size_t i = script.weights_forgotten; i < contacts->n; ++i) weights[i] = c;
  return script.error;
}

int constant_force(void*, const HapbenchContacts*, double*, HapbenchForce* answer) {
  ++script.evaluated;
  const double s = script.stiffness;
  *answer = {{0.0, script.force, 0.0}, {s, 0.0, 0.0, s, 0.0, s}};
  return script.error;
}

HapbenchPlugin plugin_of(decltype(HapbenchPlugin::evaluate) evaluate, std::uint32_t gives) {
  HapbenchPlugin plugin = {};
  plugin.version = HAPBENCH_PLUGIN_VERSION;
  plugin.gives = gives;
  plugin.name = "from_outside";
  plugin.summary = plugin.formula = plugin.source = plugin.known_failure = "a text";
  plugin.create = create;
  plugin.destroy = [](void*) { ++script.destroyed; };
  plugin.reset = [](void*) { ++script.reset; };
  plugin.evaluate = evaluate;
  plugin.error_text = [](void*, int error) { return error == 7 ? "out of luck" : nullptr; };
  return plugin;
}

const HapbenchPlugin kMean = plugin_of(mean, HAPBENCH_WEIGHTS);
const HapbenchPlugin kForce = plugin_of(constant_force, HAPBENCH_FORCE);

class APluginLaw : public testing::Test {
 protected:
  APluginLaw() { script = {}; }

  /// The fault of a law after one call.
  static std::string fault_of(const HapbenchPlugin& plugin) {
    PluginLaw law(plugin, kK, {});
    law.prepare(10);
    law.reset();
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX()});
    const LawForce force = law.evaluate(contacts);
    EXPECT_EQ(law.fault() == nullptr, force.spring.allFinite());
    return law.fault() == nullptr ? "" : law.fault();
  }
};

TEST_F(APluginLaw, OfWeightsIsTheLawOfTheseWeights) {
  PluginLaw law(kMean, kK, {});
  law.prepare(400);
  const auto mean_law = make_law("mean", {});
  ToolState tool{{kTip, Vec3::UnitZ()}, Vec3::UnitX(), Vec3(1, 2, 3)};
  test::for_random_contacts([&](ContactBuffer contacts, const char* family) {
    ContactBuffer same = contacts;
    const LawForce force = law.evaluate(contacts), expected = mean_law->evaluate(same);
    EXPECT_EQ(force.spring, expected.spring) << family;
    EXPECT_EQ(force.S, expected.S) << family;
    const SpringState state = law.spring_state(contacts, force.spring, kTip),
                      expected_state = mean_law->spring_state(same, force.spring, kTip);
    EXPECT_EQ(state.energy, expected_state.energy);
    EXPECT_EQ(state.moment, expected_state.moment);
    EXPECT_EQ(law.turning_velocity(contacts, force.S, tool), mean_law->turning_velocity(same, force.S, tool));
  });
}

TEST_F(APluginLaw, OfAForceAnswersThatForce) {
  PluginLaw law(kForce, kK, {});
  law.prepare(10);
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  const LawForce force = law.evaluate(contacts);
  EXPECT_EQ(force.spring, Vec3(0, -1, 0));
  EXPECT_EQ(force.S, Mat3(0.5 * Mat3::Identity()));
  // One spring of stiffness K at the mean of the contacts, which lie at the origin.
  const SpringState state = law.spring_state(contacts, force.spring, kTip);
  EXPECT_DOUBLE_EQ(state.energy, 1.0 / (2.0 * kK));
  EXPECT_TRUE(state.moment.isApprox((-kTip).cross(force.spring)));
}

TEST_F(APluginLaw, MayKnowItsOwnSprings) {
  HapbenchPlugin plugin = kForce;
  plugin.springs = [](void*, const HapbenchContacts* contacts, const double tip[3], double* energy, double moment[3]) {
    *energy = static_cast<double>(contacts->n);
    for (int i = 0; i < 3; ++i) moment[i] = 2.0 * tip[i];
  };
  PluginLaw law(plugin, kK, {});
  law.prepare(10);
  const ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  const SpringState state = law.spring_state(contacts, Vec3::Zero(), kTip);
  EXPECT_EQ(state.energy, 2.0);
  EXPECT_EQ(state.moment, Vec3(2.0 * kTip));
}

TEST_F(APluginLaw, SaysWhatIsNoForce) {
  EXPECT_EQ(fault_of(kMean), "");
  EXPECT_EQ(fault_of(kForce), "");
  script.weights_forgotten = 1;
  EXPECT_EQ(fault_of(kMean), "from_outside gives a force that is not finite");
  script = {.weight_scale = kNaN};
  EXPECT_EQ(fault_of(kMean), "from_outside gives a force that is not finite");
  script = {.weight_scale = 1e306};  // the depths of 1 mm leave the force finite
  EXPECT_EQ(fault_of(kMean), "");
  script = {.weight_scale = std::numeric_limits<double>::infinity()};
  EXPECT_EQ(fault_of(kMean), "from_outside gives a force that is not finite");
  script = {.force = kNaN};
  EXPECT_EQ(fault_of(kForce), "from_outside gives a force that is not finite");
  script = {.stiffness = kNaN};
  EXPECT_EQ(fault_of(kForce), "from_outside gives a stiffness that is not finite");
  script = {.creates = false};
  EXPECT_EQ(fault_of(kMean), "from_outside could not be created with these parameters");
}

TEST_F(APluginLaw, MayThrowAnywhere) {
  HapbenchPlugin plugin = kMean;
  plugin.evaluate = [](void*, const HapbenchContacts*, double*, HapbenchForce*) -> int {
    throw std::runtime_error("no force today");
  };
  EXPECT_EQ(fault_of(plugin), "from_outside throws in evaluate: no force today");
  plugin = kMean;
  plugin.reset = [](void*) { throw 1; };
  EXPECT_EQ(fault_of(plugin), "from_outside throws in reset");
  plugin = kMean;
  plugin.create = [](const double*, double, std::size_t) -> void* { throw 1; };
  EXPECT_EQ(fault_of(plugin), "from_outside could not be created with these parameters");
  plugin = kForce;
  plugin.springs = [](void*, const HapbenchContacts*, const double*, double*, double*) { throw 1; };
  const ContactBuffer contacts = test::contacts_of({Vec3::UnitX()});
  EXPECT_TRUE(std::isnan(PluginLaw(plugin, kK, {}).spring_state(contacts, Vec3::Zero(), kTip).energy));
  plugin = kMean;
  plugin.destroy = [](void*) { throw 1; };
  take_plugin_faults();
  EXPECT_EQ(fault_of(plugin), "");
  EXPECT_EQ(take_plugin_faults().first, "from_outside throws in destroy");
}

TEST_F(APluginLaw, DoesNotWriteBeyondWhatItIsGiven) {
  static std::ptrdiff_t place;
  HapbenchPlugin plugin = kMean;
  plugin.evaluate = [](void*, const HapbenchContacts* contacts, double* weights, HapbenchForce*) {
    std::fill_n(weights, contacts->n, 0.25);
    volatile double* anywhere = weights;  // what a compiler cannot see through, as in a library of its own
    anywhere[place] = 0.0;
    return 0;
  };
  place = 2;
  EXPECT_EQ(fault_of(plugin), "") << "the last of three contacts";
  for (const std::ptrdiff_t beyond : {3, 10, -1, -8}) {
    place = beyond;
    EXPECT_EQ(fault_of(plugin), "from_outside writes beyond its weights, of which there is one for each contact");
  }
  plugin.gives = HAPBENCH_FORCE;
  plugin.evaluate = [](void*, const HapbenchContacts*, double*, HapbenchForce* answer) {
    *answer = {{1, 0, 0}, {1, 0, 0, 1, 0, 1}};
    volatile double* anywhere = answer->force;
    anywhere[place] = 0.0;
    return 0;
  };
  place = 8;
  EXPECT_EQ(fault_of(plugin), "");
  for (const std::ptrdiff_t beyond : {9, -1}) {
    place = beyond;
    EXPECT_EQ(fault_of(plugin), "from_outside writes beyond its answer");
  }
}

TEST(PluginCall, OfANewThreadTakesWhatAnEndedOneHasLeft) {
  const auto allocations_of_a_call = [](const std::function<void()>& meanwhile) {
    std::uint64_t allocations = 0;
    std::thread([&] {
      const AllocationCount count;
      const PluginCall call("from_outside", "evaluate");
      allocations = count.value();
      meanwhile();
    }).join();
    return allocations;
  };
  std::uint64_t beside = 0;
  allocations_of_a_call([&] { beside = allocations_of_a_call([] {}); });
  EXPECT_LT(allocations_of_a_call([] {}), beside);
}

using APluginLawDeathTest = APluginLaw;
TEST_F(APluginLawDeathTest, IsNamedWhenItEndsTheProcess) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  HapbenchPlugin plugin = kMean;
  const auto run = [&plugin] {
    name_plugins_that_end_the_process(17);
    fault_of(plugin);
  };
  plugin.evaluate = [](void*, const HapbenchContacts*, double*, HapbenchForce*) -> int { std::exit(0); };
  EXPECT_EXIT(run(), testing::ExitedWithCode(17), "the plugin from_outside ended the program in evaluate");
  plugin.evaluate = [](void*, const HapbenchContacts*, double*, HapbenchForce*) -> int { std::abort(); };
  EXPECT_DEATH(run(), "the plugin from_outside aborted in evaluate");
  plugin.reset = [](void*) { std::raise(SIGSEGV); };
  EXPECT_DEATH(run(), "the plugin from_outside crashed in reset");
}

TEST_F(APluginLaw, IsNotAskedAgainAfterAnErrorUntilAReset) {
  take_plugin_faults();
  PluginLaw law(kMean, kK, {});
  law.prepare(10);
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  script.error = 7;
  law.evaluate(contacts);
  EXPECT_STREQ(law.fault(), "from_outside reports error 7: out of luck");
  script.error = 0;
  EXPECT_FALSE(law.evaluate(contacts).spring.allFinite());
  EXPECT_EQ(script.evaluated, 1);
  const PluginFaults faults = take_plugin_faults();
  EXPECT_EQ(faults.count, 1u);
  EXPECT_EQ(faults.first, "from_outside reports error 7: out of luck");
  EXPECT_EQ(take_plugin_faults().count, 0u);
  law.reset();
  EXPECT_EQ(law.fault(), nullptr);
  EXPECT_TRUE(law.evaluate(contacts).spring.allFinite());
  script.error = -3;
  law.evaluate(contacts);
  EXPECT_STREQ(law.fault(), "from_outside reports error -3");
}

TEST_F(APluginLaw, IsNotAskedWithoutContacts) {
  PluginLaw law(kMean, kK, {});
  law.prepare(10);
  ContactBuffer contacts(10);
  contacts.pad();
  EXPECT_EQ(law.evaluate(contacts).spring, Vec3::Zero());
  EXPECT_EQ(script.evaluated, 0);
}

TEST_F(APluginLaw, IsDestroyedOnceForEachCreation) {
  {
    PluginLaw law(kMean, kK, {});
    law.prepare(10);
    law.prepare(20);
    EXPECT_EQ(script.destroyed, 1);
  }
  EXPECT_EQ(script.destroyed, 2);
  script = {.creates = false};
  {
    PluginLaw law(kMean, kK, {});
    law.prepare(10);
  }
  EXPECT_EQ(script.destroyed, 0);
}

TEST_F(APluginLaw, AllocatesNothingInAStep) {
  for (const HapbenchPlugin* plugin : {&kMean, &kForce}) {
    PluginLaw law(*plugin, kK, {});
    law.prepare(10);
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
    const AllocationCount count;
    for (int i = 0; i < 10; ++i) {
      const LawForce force = law.evaluate(contacts);
      law.spring_state(contacts, force.spring, kTip);
    }
    law.reset();
    EXPECT_EQ(count.value(), 0u);
  }
}

/// virtual_coupling as a law from outside, with weights, force, tensor and springs.
class Coupling final : public ForceLaw {
 public:
  Coupling(double stiffness, std::span<const double> parameters) : ForceLaw(stiffness) {
    RenderingConfig config;
    config.stiffness = stiffness;
    config.virtual_coupling = parameters[0];
    law_ = make_law("virtual_coupling", config);
  }
  LawForce evaluate(ContactBuffer& contacts) noexcept override { return law_->evaluate(contacts); }
  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override {
    return law_->spring_state(contacts, spring, tip);
  }

 private:
  std::unique_ptr<ForceLaw> law_;
};

TEST(ALawPlugin, IsItsLawToTheLastBit) {
  constexpr HapbenchParameter kParameters[] = {{"coupling_N_per_m", "N/m", 1.0, 1e6, 1e4, "K_vc"}};
  const HapbenchPlugin plugin = LawPlugin<Coupling>::of({"coupling", "a", "b", "c", "d"}, kParameters);
  PluginLaw law(plugin, kK, {5000.0});
  law.prepare(400);
  RenderingConfig config;
  config.stiffness = kK;
  config.virtual_coupling = 5000.0;
  const auto direct = make_law("virtual_coupling", config);
  test::for_random_contacts([&](ContactBuffer contacts, const char* family) {
    ContactBuffer same = contacts;
    const AllocationCount count;
    const LawForce force = law.evaluate(contacts);
    const SpringState state = law.spring_state(contacts, force.spring, kTip);
    EXPECT_EQ(count.value(), 0u);
    const LawForce expected = direct->evaluate(same);
    EXPECT_EQ(force.spring, expected.spring) << family;
    EXPECT_EQ(force.S, expected.S) << family;
    const SpringState expected_state = direct->spring_state(same, expected.spring, kTip);
    EXPECT_EQ(state.energy, expected_state.energy) << family;
    EXPECT_EQ(state.moment, expected_state.moment) << family;
    EXPECT_EQ(contacts.weight, same.weight) << family;
  });
}

TEST(ALawPlugin, CannotBeCreatedWhenTheConstructorThrows) {
  struct Refuses final : ForceLaw {
    Refuses(double stiffness, std::span<const double>) : ForceLaw(stiffness) { throw std::runtime_error("no"); }
    LawForce evaluate(ContactBuffer&) noexcept override { return {}; }
  };
  const HapbenchPlugin plugin = LawPlugin<Refuses>::of({"refuses", "a", "b", "c", "d"});
  EXPECT_EQ(plugin.create(nullptr, kK, 10), nullptr);
}

}  // namespace
}  // namespace hapbench::plugin_law_test
