#include <fmt/format.h>
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/thesis/choices.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/scenarios/support/schema_validator.hpp"

namespace hapbench::choices_test {
namespace {

namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

const fs::path kReference = fs::path(HAPBENCH_SCENARIOS) / "../../results/reference";

Json effective(const BundledScenario& bundled, const Texts& overrides) {
  const LoadedScenario loaded = load_scenario(bundled.file, overrides);
  Json json = effective_scenario(loaded.scenario, loaded.scenario.directory);
  json.erase("expect");  // an overridden run is judged by less
  return json;
}

std::vector<BundledScenario> thesis_scenarios() {
  std::vector<BundledScenario> all = bundled_scenarios();
  // Beside the thesis's, claim C2 is judged on two of ours.
  std::erase_if(all, [](const BundledScenario& bundled) {
    return bundled.group != "thesis" && !bundled.name.starts_with("turned_into_wall");
  });
  return all;
}

/// Tests each field of each choice, so that none is lost when a scenario is renamed.
TEST(ChoicesOnRecord, AreWhatTheScenariosHaveAndOthersChangeThem) {
  const Choices choices(kReference / "choices.json");
  const Texts on_record = choices.values_on_record();
  // Ends of ranges and options other than the one on record; one of them differs from it.
  Texts low, high;
  for (const OpenChoice& choice : choices.all()) {
    low.push_back(choice.range ? fmt::format("{}", choice.range->first) : choice.options.front());
    high.push_back(choice.range ? fmt::format("{}", choice.range->second) : choice.options.back());
  }
  std::set<std::string> changing;
  for (const BundledScenario& bundled : thesis_scenarios()) {
    const Scenario scenario = load_scenario(bundled.file).scenario;
    const Texts recorded = choices.overrides(scenario, on_record);
    const Json without = effective(bundled, {});
    EXPECT_EQ(effective(bundled, recorded), without) << bundled.name;
    for (std::size_t c = 0; c < choices.all().size(); ++c) {
      if (changing.contains(choices.all()[c].id)) continue;
      for (const Texts& other : {low, high}) {
        Texts values = on_record;
        values[c] = other[c];
        const Texts overrides = choices.overrides(scenario, values);
        if (overrides != recorded && effective(bundled, overrides) != without) changing.insert(choices.all()[c].id);
      }
    }
  }
  for (const OpenChoice& choice : choices.all())  // those without fields are numbers of rules
    EXPECT_EQ(changing.contains(choice.id), !choice.fields.empty()) << choice.id;
}

TEST(ChoicesOnRecord, NameScenariosThatThereAre) {
  const Choices choices(kReference / "choices.json");
  const std::vector<BundledScenario> scenarios = thesis_scenarios();
  for (const OpenChoice& choice : choices.all()) {
    for (const ChosenField& field : choice.fields) {
      for (const std::string& pattern : field.scenarios)
        EXPECT_TRUE(
            std::any_of(scenarios.begin(), scenarios.end(),
                        [&](const BundledScenario& b) { return ::fnmatch(pattern.c_str(), b.name.c_str(), 0) == 0; }))
            << choice.id << ": " << pattern;
    }
  }
}

TEST(ChoicesOnRecord, AreAsTheSchemaSays) {
  const test::SchemaValidator schema(choices_schema());
  EXPECT_EQ(schema.complaints(Json::parse(test::read_file(kReference / "choices.json"))), "");
  for (const char* other : {R"({"choices": [{"id": "a"}]})", R"({"choice": []})", R"({"choices": []})"})
    EXPECT_NE(schema.complaints(Json::parse(other)), "") << other;
}

/// What the schema cannot say: a reading is one value for each choice, in a cell without quotes.
TEST(ChoicesOnRecord, AreInTheirRangesAndFitIntoTables) {
  const Choices choices(kReference / "choices.json");
  std::set<std::string> ids;
  for (const OpenChoice& choice : choices.all()) {
    EXPECT_TRUE(ids.insert(choice.id).second) << choice.id << " twice";
    const auto number = finite_number(choice.value);
    Texts texts = choice.options;
    texts.insert(texts.end(), {choice.id, choice.value});
    for (const std::string& text : texts) EXPECT_EQ(text.find_first_of(" ,\"\t\n"), std::string::npos) << text;
    if (choice.range) {
      const auto [low, high] = *choice.range;
      EXPECT_TRUE(number && low < high && low <= *number && *number <= high) << choice.id;
    } else {
      EXPECT_EQ(std::count(choice.options.begin(), choice.options.end(), choice.value), 1) << choice.id;
    }
    const bool read_by_rules = choice.fields.empty();
    for (const std::string& option : choice.options)
      EXPECT_TRUE(!read_by_rules || finite_number(option)) << choice.id << ": rules read numbers";
    for (const ChosenField& field : choice.fields)
      EXPECT_TRUE(!field.times || (choice.range && choice.value == "1")) << choice.id << " multiplies";
  }
}

class ChoicesFile : public testing::Test {
 protected:
  Choices read(const Json& file) const {
    test::write_plainly(directory_ / "choices.json", file.dump());
    return Choices(directory_ / "choices.json");
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
  static Json file(const std::vector<Json>& choices) { return {{"choices", choices}}; }
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

TEST_F(ChoicesFile, GivesOverridesOfScenariosItNames) {
  const Choices choices = read(file({factor(), option()}));
  EXPECT_EQ(choices.values_on_record(), (Texts{"1", "a"}));
  Json springs = {{"name", "task1"},
                  {"time", {{"step_s", 0.001}, {"steps", 1}}},
                  {"environment", {{"type", "springs"}, {"groups", {{{"direction", {1, 0, 0}}, {"count", 1}}}}}}};
  EXPECT_EQ(choices.overrides(scenario_of(springs), Texts{"1.5", "b"}), (Texts{"rendering.stiffness_N_per_m=30000"}));
  springs["name"] = "atask1";
  EXPECT_TRUE(choices.overrides(scenario_of(springs), Texts{"1.5", "b"}).empty());
}

TEST_F(ChoicesFile, ReachesEveryEntryOfAListAndMultipliesInOrder) {
  Json every = factor(), again = factor();
  every["fields"][0]["path"] = "hand.subjects.*.press_N";
  again["id"] = "second";
  again["fields"][0]["path"] = "hand.subjects.1.press_N";
  const Choices choices = read(file({every, again}));
  EXPECT_EQ(choices.overrides(scenario_of(subjects_scenario()), Texts{"2", "1.5"}),
            (Texts{"hand.subjects.0.press_N=3", "hand.subjects.1.press_N=6"}));
}

TEST_F(ChoicesFile, RefusesPathsThatAreNotThere) {
  for (const char* path : {"hand.subjects.2.press_N", "hand.subjects.*.pres_N", "hand.nothing", "hand.type"}) {
    Json choice = factor();
    choice["fields"][0]["path"] = path;
    const Choices choices = read(file({choice}));
    const auto error = test::input_error_of([&] { choices.overrides(scenario_of(subjects_scenario()), Texts{"2"}); });
    ASSERT_TRUE(error) << path;
    EXPECT_EQ(std::string(error->what()).find("choice \"stiffness\": in scenario task2_x, "), 0u) << error->what();
  }
}

TEST_F(ChoicesFile, WithoutFieldsAreNumbersThatRulesRead) {
  Json number = factor();
  number["id"] = "rule.easily";
  number.erase("fields");
  const Choices choices = read(file({number, option()}));
  const PublishedNumbers published(kReference / "published.json");
  EXPECT_EQ(choices.with_numbers(published, Texts{"1.5", "a"})["rule.easily"].mean, 1.5);
  const Texts task = {"task2_a"}, other = {"task3"};
  EXPECT_EQ(choices.reach(other, "at least <T2.raw> times"), "");
  const std::string by_rule = choices.reach(other, "at least <rule.easily> times"), by_scene = choices.reach(task, "");
  EXPECT_NE(by_rule, "");
  EXPECT_NE(by_scene, "");
  EXPECT_NE(by_rule, by_scene);
  EXPECT_EQ(choices.reach(other, "<rule.easily.mean*100> %"), by_rule);
}

TEST_F(ChoicesFile, ChangesItsHashWithItsContentOnly) {
  const std::string hash = read(file({factor()})).hash();
  test::write_plainly(directory_ / "choices.json", file({factor()}).dump(7));
  EXPECT_EQ(Choices(directory_ / "choices.json").hash(), hash);
  EXPECT_NE(read(file({factor(), option()})).hash(), hash);
}

TEST_F(ChoicesFile, NamesTheChoiceThatLacksAPart) {
  Json without = option();
  without.erase("value");
  const auto error = test::input_error_of([&] { read(file({factor(), without})); });
  ASSERT_TRUE(error);
  const std::string said = error->what();
  EXPECT_NE(said.find("choices.json: /choices/1: "), std::string::npos) << said;
  EXPECT_NE(said.find("'value' not found; allowed: what choices.schema.json says"), std::string::npos) << said;
}

}  // namespace
}  // namespace hapbench::choices_test
