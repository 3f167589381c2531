#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "algorithms/module/law_module.hpp"
#include "algorithms/module/module.hpp"
#include "algorithms/penalty_rendering.hpp"
#include "algorithms/registry.hpp"
#include "results/summary/allocations.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::module_test {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<ForceAlgorithm> make_some(const RenderingConfig& config) {
  return std::make_unique<PenaltyRendering>(make_law("mean", config), config);
}

/// Adds an algorithm. Returns the reason why it was rejected, or an empty text.
std::string problem_with(const ModelInfo& info, std::vector<AlgorithmParameter> parameters = {}) {
  try {
    add_algorithm({.info = &info, .make = make_some, .algorithm_parameters = parameters});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(AddedAlgorithm, IsFoundAndCanBeReplaced) {
  const std::size_t before = algorithms().size(), additions_before = additions();
  const AlgorithmEntry& mean = *find_algorithm("mean");
  std::string text = "text";  // the registry copies this text
  const AlgorithmParameter own{"gain", {0, 2, "1"}, 0.5, "m"};
  EXPECT_EQ(problem_with({"added", text.c_str(), "a", "b", "c"}, {own}), "");
  text = "other";
  ASSERT_EQ(algorithms().size(), before + 1);
  EXPECT_EQ(algorithm_names().back(), "added");
  EXPECT_EQ(&mean, find_algorithm("mean"));
  const AlgorithmEntry& added = *find_algorithm("added");
  EXPECT_STREQ(added.info->summary, "text");
  RenderingConfig config;
  config.algorithm = "added";
  EXPECT_NE(make_algorithm(config), nullptr);
  EXPECT_EQ(parameter_values(config, added), std::vector<double>{0.5});

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
  const auto with = [](std::vector<AlgorithmParameter> own) {
    return problem_with({"x", "a", "b", "c", "d"}, std::move(own));
  };
  const AlgorithmParameter good{"p", {0, 1, "1"}, 0.5, "meaning"};
  EXPECT_EQ(with({good, good}), "parameter \"p\" occurs twice");
  EXPECT_TRUE(with({{"a b", good.range, 0.5, "m"}}).starts_with("a parameter is called \"a b\"; allowed"));
  EXPECT_EQ(with({{"p", good.range, 1.5, "m"}}), "parameter \"p\": its default is out of its range");
  EXPECT_EQ(with({{"p", {0, 1, "1", true}, 0.0, "m"}}), "parameter \"p\": its default is out of its range");
  EXPECT_EQ(with({{"p", good.range, std::numeric_limits<double>::quiet_NaN(), "m"}}),
            "parameter \"p\": its default is out of its range");
  for (const NumberRange range : {NumberRange{1, 0, "1"}, {1, 1, "1"}, {0, kInfinity, "1"}})
    EXPECT_EQ(with({{"p", range, 0.5, "m"}}),
              "parameter \"p\": a range needs two finite limits, the lower limit first");
  EXPECT_EQ(with({{"p", {0, 1, nullptr}, 0.5, "m"}}), "parameter \"p\": its unit is missing");
  EXPECT_EQ(with({{"p", good.range, 0.5, nullptr}}), "parameter \"p\": its meaning is missing");
  EXPECT_EQ(algorithms().size(), before);
}

constexpr double kK = 20000.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Vec3 kTip(0.1, -0.2, 0.3);

/// Behaviour of the laws below, and counts of the calls of their functions.
struct Script {
  const char* fault = nullptr;
  double weight_scale = 1.0;
  std::size_t weights_forgotten = 0;
  double force = -1.0;
  double stiffness = 0.5;
  bool creates = true;
  int steps = 0, reset = 0, destroyed = 0;
};
Script script;

int say(const char* why, char* fault) {
  if (why != nullptr) std::snprintf(fault, HAPBENCH_FAULT_SIZE, "%s", why);
  return why != nullptr ? 1 : 0;
}

void* create(const double*, const char*, const HapbenchRun*, char* fault) {
  if (script.creates) return &script;
  say("out of clay", fault);
  return nullptr;
}

int mean(void*, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce*, char* fault) {
  ++script.steps;
  const double c = script.weight_scale / static_cast<double>(contacts->n);
  for (std::size_t i = script.weights_forgotten; i < contacts->n; ++i) contacts->weight[i] = c;
  return say(script.fault, fault);
}

int constant_force(void*, const HapbenchPose*, HapbenchContacts*, HapbenchForce* answer, char* fault) {
  const double s = script.stiffness;
  *answer = {1, {0.0, script.force, 0.0}, {s, 0.0, 0.0, s, 0.0, s}};
  return say(script.fault, fault);
}

HapbenchModule law_with(decltype(HapbenchModule::step) step) {
  HapbenchModule table = {};
  table.version = HAPBENCH_MODULE_VERSION;
  table.kind = HAPBENCH_LAW;
  table.name = "from_outside";
  table.create = create;
  table.step = step;
  table.reset = [](void*) { ++script.reset; };
  table.destroy = [](void*) { ++script.destroyed; };
  return table;
}

const HapbenchModule kMean = law_with(mean);
const HapbenchModule kForce = law_with(constant_force);

Module module_of(const HapbenchModule& table) {
  return {std::make_shared<HapbenchModule>(table), "file.so"};
}

class AModuleLaw : public testing::Test {
 protected:
  AModuleLaw() { script = {}; }

  /// Calls a law once and returns its fault, without the names of module and file; empty without a fault.
  static std::string fault_of(const HapbenchModule& table) {
    ModuleLaw law(module_of(table), kK, {});
    law.prepare(10);
    law.reset();
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitX()});
    const LawForce force = law.evaluate(contacts);
    EXPECT_EQ(law.fault() == nullptr, force.spring.allFinite());
    if (law.fault() == nullptr) return "";
    const std::string fault = law.fault(), start = "from_outside (file.so) ";
    EXPECT_TRUE(fault.starts_with(start)) << fault;
    return fault.substr(start.size());
  }
};

TEST_F(AModuleLaw, OfWeightsIsTheLawOfTheseWeights) {
  ModuleLaw law(module_of(kMean), kK, {});
  law.prepare(400);
  const auto mean_law = make_law("mean", {});
  ToolState tool{{kTip, Vec3::UnitZ()}, Vec3::UnitX(), Vec3(1, 2, 3)};
  test::for_random_contacts([&](ContactBuffer contacts, const char* family) {
    ContactBuffer same = contacts;
    const AllocationCount count;
    const LawForce force = law.evaluate(contacts);
    EXPECT_EQ(count.value(), 0u);
    const LawForce expected = mean_law->evaluate(same);
    EXPECT_EQ(force.spring, expected.spring) << family;
    EXPECT_EQ(force.S, expected.S) << family;
    const SpringState state = law.spring_state(contacts, force.spring, kTip),
                      expected_state = mean_law->spring_state(same, force.spring, kTip);
    EXPECT_EQ(state.energy, expected_state.energy);
    EXPECT_EQ(state.moment, expected_state.moment);
    EXPECT_EQ(law.turning_velocity(contacts, force.S, tool), mean_law->turning_velocity(same, force.S, tool));
  });
}

TEST_F(AModuleLaw, OfAForceAnswersThatForce) {
  ModuleLaw law(module_of(kForce), kK, {});
  law.prepare(10);
  ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  const LawForce force = law.evaluate(contacts);
  EXPECT_EQ(force.spring, Vec3(0, -1, 0));
  EXPECT_EQ(force.S, Mat3(0.5 * Mat3::Identity()));
  EXPECT_EQ(contacts.weight[1], 0.5) << "it wrote none";
  // The law renders the force of one spring of stiffness K at the mean position of the contacts, which all lie at the
  // origin.
  const SpringState state = law.spring_state(contacts, force.spring, kTip);
  EXPECT_DOUBLE_EQ(state.energy, 1.0 / (2.0 * kK));
  EXPECT_TRUE(state.moment.isApprox((-kTip).cross(force.spring)));
}

TEST_F(AModuleLaw, ReportsWhatIsNoForce) {
  EXPECT_EQ(fault_of(kMean), "");
  EXPECT_EQ(fault_of(kForce), "");
  script = {.weight_scale = 1e306};  // with depths of 1 mm the force is still finite
  EXPECT_EQ(fault_of(kMean), "");
  for (const Script& wrong :
       {Script{.weights_forgotten = 1}, Script{.weight_scale = kNaN}, Script{.weight_scale = kInfinity}}) {
    script = wrong;
    EXPECT_EQ(fault_of(kMean), "gives a force that is not finite");
  }
  for (const double wrong : {kNaN, kInfinity}) {
    script = {.force = wrong};
    EXPECT_EQ(fault_of(kForce), "gives a force that is not finite");
    script = {.stiffness = wrong};
    EXPECT_EQ(fault_of(kForce), "gives a stiffness that is not finite");
  }
  script = {.fault = ""};
  EXPECT_EQ(fault_of(kForce), "fails in step: no reason given");
  script = {.creates = false};
  EXPECT_EQ(fault_of(kMean), "fails in create: out of clay");
}

TEST_F(AModuleLaw, MayThrowAnywhere) {
  HapbenchModule table = kMean;
  table.step = [](void*, const HapbenchPose*, HapbenchContacts*, HapbenchForce*, char*) -> int {
    throw std::runtime_error("no force today");
  };
  EXPECT_EQ(fault_of(table), "throws in step: no force today");
  table = kMean;
  table.reset = [](void*) { throw 1; };
  EXPECT_EQ(fault_of(table), "throws in reset");
  table = kMean;
  table.create = [](const double*, const char*, const HapbenchRun*, char*) -> void* { throw 1; };
  EXPECT_EQ(fault_of(table), "throws in create");
  table = kMean;
  table.destroy = [](void*) { throw 1; };
  take_module_faults();
  EXPECT_EQ(fault_of(table), "");
  EXPECT_EQ(take_module_faults().first, "from_outside (file.so) throws in destroy");
}

TEST_F(AModuleLaw, DoesNotWriteBeyondItsWeights) {
  static std::ptrdiff_t place;
  const HapbenchModule table =
      law_with([](void*, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce*, char*) {
        std::fill_n(contacts->weight, contacts->n, 0.25);
        volatile double* anywhere = contacts->weight;  // hides the access from the compiler
        anywhere[place] = 0.0;
        return 0;
      });
  place = 2;
  EXPECT_EQ(fault_of(table), "") << "the last of three contacts";
  for (const std::ptrdiff_t beyond : {3, 10, -1, -8}) {
    place = beyond;
    EXPECT_EQ(fault_of(table), "writes beyond its weights, of which there is one for each contact");
  }
}

TEST_F(AModuleLaw, CannotChangeItsContacts) {
  static void (*change)(HapbenchContacts&);
  HapbenchModule table = law_with([](void*, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce*, char*) {
    std::fill_n(contacts->weight, contacts->n, 0.25);
    change(*contacts);
    return 0;
  });
  const auto fault = [](const std::string& field) {
    return "changes the contacts (" + field + "); allowed: writing the weights, or force and stiffness (HapbenchForce)";
  };
  const std::pair<const char*, void (*)(HapbenchContacts&)> changes[] = {
      {"n", [](HapbenchContacts& c) { --c.n; }},
      {"index", [](HapbenchContacts& c) { ++c.index[2]; }},
      {"depth", [](HapbenchContacts& c) { c.depth[0] -= 2e-5; }},
      {"gx", [](HapbenchContacts& c) { c.gx[0] = 0.5; }},
      {"gz", [](HapbenchContacts& c) { c.gz[2] = -0.0; }},
      {"z", [](HapbenchContacts& c) { c.z[2] = kNaN; }},
      {"nz", [](HapbenchContacts& c) { const_cast<double*>(c.nz)[2] = 0.5; }},
      {"depth", [](HapbenchContacts& c) { c.weight[c.n + 8] = 0.5; }}};
  for (const auto& [field, function] : changes) {
    change = function;
    EXPECT_EQ(fault_of(table), fault(field));
  }
  // The contacts of the run keep their values, also if the module gives the force or reports a fault of its own.
  table.step = [](void*, const HapbenchPose*, HapbenchContacts* contacts, HapbenchForce* answer, char*) {
    contacts->depth[0] = 1.0;
    *answer = {1, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0, 1.0, 0.0, 1.0}};
    return script.fault == nullptr ? 0 : 1;
  };
  EXPECT_EQ(fault_of(table), fault("depth"));
  for (const char* own : {static_cast<const char*>(nullptr), ""}) {
    script.fault = own;
    ModuleLaw law(module_of(table), kK, {});
    law.prepare(10);
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
    const double depth = contacts.depth[0];
    law.evaluate(contacts);
    EXPECT_EQ(contacts.depth[0], depth);
    EXPECT_NE(law.fault(), nullptr);
  }
}

TEST_F(AModuleLaw, IsNotAskedAgainAfterAFaultUntilAReset) {
  take_module_faults();
  ModuleLaw law(module_of(kMean), kK, {});
  law.prepare(10);
  ContactBuffer none(10), contacts = test::contacts_of({Vec3::UnitX(), Vec3::UnitY()});
  none.pad();
  EXPECT_EQ(law.evaluate(none).spring, Vec3::Zero());
  EXPECT_EQ(script.steps, 0);
  script.fault = "out of\nluck";
  law.evaluate(contacts);
  EXPECT_STREQ(law.fault(), "from_outside (file.so) fails in step: out of?luck");
  script.fault = nullptr;
  EXPECT_FALSE(law.evaluate(contacts).spring.allFinite());
  EXPECT_EQ(script.steps, 1);
  const ModuleFaults faults = take_module_faults();
  EXPECT_EQ(faults.count, 1u);
  EXPECT_EQ(faults.first, "from_outside (file.so) fails in step: out of?luck");
  EXPECT_EQ(take_module_faults().count, 0u);
  law.reset();
  EXPECT_EQ(script.reset, 1);
  EXPECT_EQ(law.fault(), nullptr);
  EXPECT_TRUE(law.evaluate(contacts).spring.allFinite());
}

/// A law in C++ that calls `disturb` in each function, with the name of the function.
struct DisturbedLaw final : ExternalForceLaw {
  static inline void (*disturb)(std::string_view function, ContactBuffer* contacts) = nullptr;

  DisturbedLaw(double stiffness, const double*) : ExternalForceLaw(stiffness) { disturb("constructor", nullptr); }
  void prepare(std::size_t) override { disturb("prepare", nullptr); }
  void reset() override { disturb("reset", nullptr); }
  LawForce evaluate(ContactBuffer& contacts) override {
    set_weights(contacts, 0.25);
    disturb("evaluate", &contacts);
    return weighted_force(contacts, K_);
  }
};

TEST_F(AModuleLaw, InCppMayThrowAnywhere) {
  const HapbenchModule table = law_module<DisturbedLaw>({"from_outside", "a", "b", "c", "d"});
  static std::string_view failing;
  DisturbedLaw::disturb = [](std::string_view function, ContactBuffer*) {
    if (function == failing) throw std::runtime_error("no");
  };
  for (const auto& [function, fault] : {std::pair{"no function", ""},
                                        {"constructor", "throws in create: no"},
                                        {"prepare", "throws in create: no"},
                                        {"reset", "throws in reset: no"},
                                        {"evaluate", "throws in step: no"}}) {
    failing = function;
    EXPECT_EQ(fault_of(table), fault) << function;
  }
}

TEST_F(AModuleLaw, InCppCannotChangeItsContacts) {
  const HapbenchModule table = law_module<DisturbedLaw>({"from_outside", "a", "b", "c", "d"});
  static void (*change)(ContactBuffer&);
  DisturbedLaw::disturb = [](std::string_view, ContactBuffer* contacts) {
    if (contacts != nullptr) change(*contacts);
  };
  const std::pair<const char*, void (*)(ContactBuffer&)> changes[] = {
      {"their number", [](ContactBuffer& c) { c.shrink(1); }},
      {"index", [](ContactBuffer& c) { ++c.index[2]; }},
      {"depth", [](ContactBuffer& c) { c.depth[1] *= 2.0; }},
      {"uz", [](ContactBuffer& c) { c.uz[0] = 0.5; }},
      {"nx", [](ContactBuffer& c) { c.nx[2] = 0.5; }}};
  for (const auto& [field, function] : changes) {
    change = function;
    EXPECT_EQ(fault_of(table),
              fmt::format("fails in step: it changes the contacts ({}); allowed: writing the weights", field));
  }
}

fs::path module(const std::string& name) {
  return fs::path(HAPBENCH_TEST_MODULES) / (name + ".so");
}

/// Returns the problem of a module file, without the file's name; fails the test if the file is accepted.
std::string problem_of_file(const fs::path& file) {
  const auto error = test::input_error_of([&] { load_module(file); });
  if (!error) return "";
  const std::string what = error->what(), start = file.string() + ": ";
  EXPECT_TRUE(what.starts_with(start)) << what;
  EXPECT_EQ(what.find('\n'), what.npos);
  return what.substr(start.size());
}

TEST(LoadModule, ReportsWhatIsWrongWithAFile) {
  const std::size_t before = algorithms().size();
  EXPECT_EQ(problem_of_file("no/such.so"), "cannot be loaded as a module: No such file or directory");
  EXPECT_EQ(problem_of_file(fs::canonical(HAPBENCH_TEST_MODULES)), "is a directory, not a file");
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "text.so") << "no library";
  EXPECT_EQ(problem_of_file(fs::canonical(directory / "text.so")), "is not a module: file too short");
  EXPECT_EQ(problem_of_file(module("no_entry_point")),
            "is not a module: it has no function \"hapbench_module\" (hapbench_module.h)");
  for (const char* old : {"law", "contacts"}) {
    const std::string header = old == std::string("law") ? "hapbench_plugin.h" : "hapbench_contacts.h";
    EXPECT_EQ(problem_of_file(module(std::string("old_") + old)),
              "is built for " + header + " of an earlier version; compile it anew against hapbench_module.h");
  }
  EXPECT_NO_THROW(load_module(module("sphere"))) << "a source of contacts";
  EXPECT_EQ(algorithms().size(), before);
}

TEST(LoadModule, ReportsWhatIsWrongWithALaw) {
  const std::size_t before = algorithms().size();
  const test::TemporaryDirectory directory;
  const fs::path file = fs::canonical(directory.path()) / "not_loaded_yet.so";
  fs::copy_file(module("hostile"), file);
  const auto hostile = [&file](const char* how) {
    const test::EnvironmentVariable chosen("HOSTILE", how);
    return problem_of_file(file);
  };
  EXPECT_EQ(hostile("refuses"),
            "does not support version 1 of the interface; allowed: built with the hapbench_module.h of this program");
  EXPECT_EQ(hostile("version"), "is built for version 2 of the interface; allowed: 1");
  EXPECT_EQ(hostile("kind"), "its kind is 5; allowed: HAPBENCH_LAW or HAPBENCH_CONTACTS");
  const std::string unusable = "is not a law that can be used: ";
  EXPECT_EQ(hostile("built in"), unusable + "\"mean\" is the name of a built-in algorithm");
  EXPECT_EQ(hostile("no table"), unusable + "its table of parameters is missing");
  EXPECT_EQ(hostile("no step"), unusable + "its function \"step\" is missing");
  EXPECT_EQ(hostile("many"), unusable + "it has 1099511627776 parameters; allowed: at most 1000");
  EXPECT_EQ(algorithms().size(), before);
}

TEST(LoadModule, LoadsAFileOnceAndALawOnce) {
  load_module(module("hostile"));
  const std::size_t after = algorithms().size();
  load_module(module("hostile"));
  EXPECT_EQ(algorithms().size(), after);
  EXPECT_EQ(find_algorithm("hostile")->origin.file, "hostile.so");
  EXPECT_EQ(find_algorithm("hostile")->origin.hash.size(), 16u);
  const test::TemporaryDirectory directory;
  const fs::path copy = fs::canonical(directory.path()) / "copy.so";
  fs::copy_file(module("hostile"), copy);
  EXPECT_EQ(problem_of_file(copy), "is not a law that can be used: \"hostile\" is the name of the law in " +
                                       fs::canonical(module("hostile")).string());
}

TEST(LoadModule, RefusesALibraryThatIsCutShort) {
  const test::TemporaryDirectory directory;
  std::ifstream in(module("hostile"), std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (const std::size_t size : {std::size_t{100}, whole.size() / 3, whole.size() - 1}) {
    const fs::path file = directory / fmt::format("cut{}.so", size);
    std::ofstream(file, std::ios::binary) << whole.substr(0, size);
    EXPECT_EQ(problem_of_file(fs::canonical(file)),
              fmt::format("is cut short: it has {} of {} bytes; compile or copy it again", size, whole.size()));
  }
}

TEST(LoadModule, LeavesTheArithmeticAlone) {
  load_module(module("hostile"));
  volatile double least = std::numeric_limits<double>::min();
  EXPECT_GT(least / 2.0, 0.0);
}

TEST(LoadModule, LoadsFoldersInTheOrderOfNames) {
  const test::TemporaryDirectory directory;
  fs::copy_file(module("depth_weighted"), directory / "b.so");
  fs::copy_file(module("capped_summation"), directory / "a.so");
  std::ofstream(directory / "readme.txt") << "no module";
  load_modules_in("PATH", ":" + directory.path().string() + ":");
  ASSERT_GE(algorithm_names().size(), 2u);
  EXPECT_EQ(algorithm_names().back(), "depth_weighted");
  EXPECT_EQ(algorithm_names()[algorithm_names().size() - 2], "capped_summation");
  const auto error = test::input_error_of([] { load_modules_in("PATH", "/no/such/folder"); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "PATH: /no/such/folder: No such file or directory");
}

// ---- Parameters in scenarios

LoadedScenario scenario_with(const std::string& rendering) {
  return read_scenario(
      Json::parse(R"({"time": {"step_s": 0.001, "steps": 10}, "environment": {"type": "plane"}, "rendering": )" +
                  rendering + "}"),
      "");
}

TEST(OwnParameters, AreWrittenWithTheirAlgorithmCheckedAndInTheSchema) {
  load_module(module("hostile"));
  const auto rendering_of = [](const std::string& text) {
    return effective_scenario(scenario_with(text).scenario, "")["rendering"];
  };
  EXPECT_FALSE(rendering_of(R"({"algorithm": "mean"})").contains("parameters"));
  const std::string given = R"({"algorithm": "hostile", "parameters": {"hostile": {"bias": 0.5}}})";
  EXPECT_EQ(rendering_of(given)["parameters"], Json::parse(R"({"hostile": {"gain": 1.0, "bias": 0.5}})"));
  // Parameters of an algorithm that is not in use are allowed, because a comparison changes the algorithm.
  const std::string others = R"({"algorithm": "mean", "parameters": {"hostile": {"bias": 0.5}}})";
  EXPECT_EQ(rendering_of(others)["parameters"]["hostile"]["bias"], 0.5);
  const Scenario scenario = with_algorithm(scenario_with(others).scenario, "hostile");
  EXPECT_EQ(parameter_values(scenario.rendering, *find_algorithm("hostile")), (std::vector<double>{1.0, 0.5}));

  const auto refusal = [](const std::string& parameters) {
    const auto error = test::input_error_of([&] { scenario_with(R"({"parameters": )" + parameters + "}"); });
    return error ? std::string(error->what()) : "";
  };
  EXPECT_EQ(refusal(R"({"hostile": {"gain": 3}})"),
            "/rendering/parameters/hostile/gain: got 3; allowed: a number >= 0 and <= 2 [1]");
  EXPECT_EQ(refusal(R"({"hostile": {"gian": 1}})"),
            "/rendering/parameters/hostile/gian: unknown field; nearest valid name: \"gain\"; allowed here: "
            "\"gain\", \"bias\"");
  const std::string unknown = refusal(R"({"hostil": {"gain": 1}})");
  EXPECT_NE(unknown.find("nearest valid name: \"hostile\""), std::string::npos) << unknown;

  const Json schema = scenario_guide().schema;
  const Json& gain =
      schema.at(Json::json_pointer("/properties/rendering/properties/parameters/properties/hostile/properties/gain"));
  EXPECT_EQ(gain["default"], 1.0);
  EXPECT_EQ(gain["maximum"], 2.0);
  EXPECT_EQ(gain["description"], "scales nothing");
}

}  // namespace
}  // namespace hapbench::module_test
