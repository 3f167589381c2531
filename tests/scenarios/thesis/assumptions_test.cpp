#include <fmt/format.h>
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/thesis/assumptions.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/scenarios/support/schema_validator.hpp"

namespace hapbench::assumptions_test {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

const fs::path kReference = fs::path(HAPBENCH_SCENARIOS) / "../../results/reference";

Json effective(const BundledScenario& bundled, const Texts& overrides) {
  const LoadedScenario loaded = load_scenario(bundled.file, overrides);
  Json json = effective_scenario(loaded.scenario, loaded.scenario.directory);
  json.erase("expect");  // an overridden run has fewer expectations
  return json;
}

std::vector<BundledScenario> thesis_scenarios() {
  std::vector<BundledScenario> all = bundled_scenarios();
  // Keep the thesis's scenarios and the two scenarios of this project on which claim C2 is judged.
  std::erase_if(all, [](const BundledScenario& bundled) {
    return bundled.group != "thesis" && !bundled.name.starts_with("turned_into_wall");
  });
  return all;
}

/// Checks each field of each assumption, so that no field is lost when a scenario is renamed.
TEST(AssumptionsOnRecord, AreWhatTheScenariosHaveAndOthersChangeThem) {
  const Assumptions assumptions(kReference / "assumptions.json");
  const Texts on_record = assumptions.recorded_values();
  // Two values of each assumption: the ends of its range, or its first and last option. At least one of them differs
  // from the committed value.
  Texts low, high;
  for (const Assumption& assumption : assumptions.all()) {
    low.push_back(assumption.range ? fmt::format("{}", assumption.range->first) : assumption.options.front());
    high.push_back(assumption.range ? fmt::format("{}", assumption.range->second) : assumption.options.back());
  }
  std::set<std::string> changing;
  for (const BundledScenario& bundled : thesis_scenarios()) {
    const Scenario scenario = load_scenario(bundled.file).scenario;
    const Texts recorded = assumptions.overrides(scenario, on_record);
    const Json without = effective(bundled, {});
    EXPECT_EQ(effective(bundled, recorded), without) << bundled.name;
    for (std::size_t c = 0; c < assumptions.all().size(); ++c) {
      if (changing.contains(assumptions.all()[c].id)) continue;
      for (const Texts& other : {low, high}) {
        Texts values = on_record;
        values[c] = other[c];
        const Texts overrides = assumptions.overrides(scenario, values);
        if (overrides != recorded && effective(bundled, overrides) != without) changing.insert(assumptions.all()[c].id);
      }
    }
  }
  for (const Assumption& assumption : assumptions.all())  // assumptions without fields are numbers of rules
    EXPECT_EQ(changing.contains(assumption.id), !assumption.fields.empty()) << assumption.id;
}

TEST(AssumptionsOnRecord, NameScenariosThatThereAre) {
  const Assumptions assumptions(kReference / "assumptions.json");
  const std::vector<BundledScenario> scenarios = thesis_scenarios();
  for (const Assumption& assumption : assumptions.all()) {
    for (const AssumedField& field : assumption.fields) {
      for (const std::string& pattern : field.scenarios)
        EXPECT_TRUE(
            std::any_of(scenarios.begin(), scenarios.end(),
                        [&](const BundledScenario& b) { return ::fnmatch(pattern.c_str(), b.name.c_str(), 0) == 0; }))
            << assumption.id << ": " << pattern;
    }
  }
}

TEST(AssumptionsOnRecord, AreAsTheSchemaSays) {
  const test::SchemaValidator schema(assumptions_schema());
  EXPECT_EQ(schema.complaints(Json::parse(test::read_file(kReference / "assumptions.json"))), "");
  for (const char* other : {R"({"assumptions": [{"id": "a"}]})", R"({"assumption": []})", R"({"assumptions": []})"})
    EXPECT_NE(schema.complaints(Json::parse(other)), "") << other;
}

/// Checks conditions that the schema cannot express. For example, texts must fit into one cell of a table without
/// quotes, and each value must be in its range or among its options.
TEST(AssumptionsOnRecord, AreInTheirRangesAndFitIntoTables) {
  const Assumptions assumptions(kReference / "assumptions.json");
  std::set<std::string> ids;
  for (const Assumption& assumption : assumptions.all()) {
    EXPECT_TRUE(ids.insert(assumption.id).second) << assumption.id << " twice";
    const auto number = finite_number(assumption.value);
    Texts texts = assumption.options;
    texts.insert(texts.end(), {assumption.id, assumption.value});
    for (const std::string& text : texts) EXPECT_EQ(text.find_first_of(" ,\"\t\n"), std::string::npos) << text;
    if (assumption.range) {
      const auto [low, high] = *assumption.range;
      EXPECT_TRUE(number && low < high && low <= *number && *number <= high) << assumption.id;
    } else {
      EXPECT_EQ(std::count(assumption.options.begin(), assumption.options.end(), assumption.value), 1) << assumption.id;
    }
    const bool read_by_rules = assumption.fields.empty();
    for (const std::string& option : assumption.options)
      EXPECT_TRUE(!read_by_rules || finite_number(option)) << assumption.id << ": rules read numbers";
    for (const AssumedField& field : assumption.fields)
      EXPECT_TRUE(!field.times || (assumption.range && assumption.value == "1")) << assumption.id << " multiplies";
  }
}

class AssumptionsFile : public testing::Test {
 protected:
  Assumptions read(const Json& file) const {
    test::write_plainly(directory_ / "assumptions.json", file.dump());
    return Assumptions(directory_ / "assumptions.json");
  }
  static Json factor() {
    return {{"id", "stiffness"},
            {"what", "w"},
            {"thesis", "t"},
            {"value", 1},
            {"range", {0.5, 2}},
            {"scale", "log"},
            {"chosen", "after"},
            {"why", "y"},
            {"fields", {{{"scenarios", {"task*"}}, {"path", "rendering.stiffness_N_per_m"}, {"times", true}}}}};
  }
  static Json option() {
    return {{"id", "density"},
            {"what", "w"},
            {"thesis", "t"},
            {"value", "a"},
            {"options", {"a", "b"}},
            {"chosen", "before"},
            {"why", "y"},
            {"fields", {{{"scenarios", {"task2_*", "x"}}, {"path", "environment.density"}}}}};
  }
  static Json file(const std::vector<Json>& assumptions) { return {{"assumptions", assumptions}}; }
  test::TemporaryDirectory directory_;
};

Scenario scenario_of(const Json& json) {
  return read_scenario(json, ".").scenario;
}

Json subjects_scenario() {
  return {{"name", "task2_x"},
          {"time", {{"step_s", 0.001}, {"steps", 1}}},
          {"environment", {{"type", "plane"}, {"size_m", 0.01}, {"spacing_m", 0.001}}},
          {"hand",
           {{"type", "tracking"},
            {"task", {{"places_m", {{0, 0, 0}}}}},
            {"subjects", {{{"press_N", 1.5}}, {{"press_N", 2}}}}}}};
}

TEST_F(AssumptionsFile, GivesOverridesOfScenariosItNames) {
  const Assumptions assumptions = read(file({factor(), option()}));
  EXPECT_EQ(assumptions.recorded_values(), (Texts{"1", "a"}));
  Json springs = {{"name", "task1"},
                  {"time", {{"step_s", 0.001}, {"steps", 1}}},
                  {"environment", {{"type", "springs"}, {"groups", {{{"direction", {1, 0, 0}}, {"count", 1}}}}}}};
  EXPECT_EQ(assumptions.overrides(scenario_of(springs), Texts{"1.5", "b"}),
            (Texts{"rendering.stiffness_N_per_m=30000"}));
  springs["name"] = "atask1";
  EXPECT_TRUE(assumptions.overrides(scenario_of(springs), Texts{"1.5", "b"}).empty());
}

TEST_F(AssumptionsFile, ReachesEveryEntryOfAListAndMultipliesInOrder) {
  Json every = factor(), again = factor();
  every["fields"][0]["path"] = "hand.subjects.*.press_N";
  again["id"] = "second";
  again["fields"][0]["path"] = "hand.subjects.1.press_N";
  const Assumptions assumptions = read(file({every, again}));
  EXPECT_EQ(assumptions.overrides(scenario_of(subjects_scenario()), Texts{"2", "1.5"}),
            (Texts{"hand.subjects.0.press_N=3", "hand.subjects.1.press_N=6"}));
}

TEST_F(AssumptionsFile, RefusesPathsThatAreNotThere) {
  for (const char* path : {"hand.subjects.2.press_N", "hand.subjects.*.pres_N", "hand.nothing", "hand.type"}) {
    Json assumption = factor();
    assumption["fields"][0]["path"] = path;
    const Assumptions assumptions = read(file({assumption}));
    const auto error =
        test::input_error_of([&] { assumptions.overrides(scenario_of(subjects_scenario()), Texts{"2"}); });
    ASSERT_TRUE(error) << path;
    EXPECT_EQ(std::string(error->what()).find("assumption \"stiffness\": in scenario task2_x, "), 0u) << error->what();
  }
}

TEST_F(AssumptionsFile, WithoutFieldsAreNumbersThatRulesRead) {
  Json number = factor();
  number["id"] = "rule.easily";
  number.erase("fields");
  const Assumptions assumptions = read(file({number, option()}));
  const PublishedNumbers published(kReference / "published.json");
  EXPECT_EQ(assumptions.with_numbers(published, Texts{"1.5", "a"})["rule.easily"].mean, 1.5);
  const Texts task = {"task2_a"}, other = {"task3"};
  EXPECT_EQ(assumptions.reach(other, "at least <T2.raw> times"), "");
  const std::string by_rule = assumptions.reach(other, "at least <rule.easily> times"),
                    by_scene = assumptions.reach(task, "");
  EXPECT_NE(by_rule, "");
  EXPECT_NE(by_scene, "");
  EXPECT_NE(by_rule, by_scene);
  EXPECT_EQ(assumptions.reach(other, "<rule.easily.mean*100> %"), by_rule);
}

TEST_F(AssumptionsFile, GivesTheOtherPlausibleValues) {
  Json linear = factor(), near = factor();
  linear.update({{"id", "linear"}, {"value", 0.5}, {"scale", "linear"}});
  near.update({{"id", "near"}, {"value", 1.05}});
  const Assumptions assumptions = read(file({factor(), linear, near, option()}));
  const auto others = [&](std::size_t i) { return assumptions.all()[i].other_values(); };
  EXPECT_EQ(others(0), (Texts{"0.5", "2"})) << "1 is the geometric mean of the ends";
  EXPECT_EQ(others(1), (Texts{"1.25", "2"})) << "an end is on record";
  EXPECT_EQ(others(2), (Texts{"0.5", "2"})) << "the middle is within a tenth of the range";
  EXPECT_EQ(others(3), (Texts{"b"}));
}

TEST_F(AssumptionsFile, ChangesItsHashWithItsContentOnly) {
  const std::string hash = read(file({factor()})).hash();
  test::write_plainly(directory_ / "assumptions.json", file({factor()}).dump(7));
  EXPECT_EQ(Assumptions(directory_ / "assumptions.json").hash(), hash);
  EXPECT_NE(read(file({factor(), option()})).hash(), hash);
}

TEST_F(AssumptionsFile, NamesTheAssumptionThatLacksAPart) {
  Json without = option();
  without.erase("value");
  const auto error = test::input_error_of([&] { read(file({factor(), without})); });
  ASSERT_TRUE(error);
  const std::string message = error->what();
  EXPECT_NE(message.find("assumptions.json: /assumptions/1: "), std::string::npos) << message;
  EXPECT_NE(message.find("'value' not found; allowed: what assumptions.schema.json says"), std::string::npos)
      << message;
}

}  // namespace
}  // namespace hapbench::assumptions_test
