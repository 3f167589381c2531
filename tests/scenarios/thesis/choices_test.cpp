#include <fmt/format.h>
#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/ledger.hpp"
#include "scenarios/thesis/robustness.hpp"
#include "scenarios/thesis/sensitivity.hpp"
#include "sim/core/random.hpp"
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

/// Two choices, and claims that are made up: about the springs' stiffness, one that is costly, one that always fails.
class Robustness : public testing::Test {
 protected:
  Robustness() {
    const auto choice = [](const char* id, Json more) {
      Json json = {{"id", id}, {"what", ""}, {"thesis", ""}, {"chosen", "after"}, {"why", ""}};
      json.update(more);
      json["fields"][0]["scenarios"] = {"springs_unlimited_mean"};
      return json;
    };
    const Json path = {{"path", "rendering.stiffness_N_per_m"}, {"times", true}};
    const Json choices = {
        {"choices",
         {choice("stiffness", {{"value", 1}, {"range", {0.5, 2}}, {"fields", Json::array({path})}}),
          choice("seed", {{"value", "1"}, {"options", {"1", "2"}}, {"fields", {{{"path", "seed"}}}}})}}};
    test::write_plainly(directory_ / "choices.json", choices.dump());
  }

  static Claim claim(const char* id, Measured (*measure)(const Evidence&),
                     Finding (*judge)(const Measured&, const PublishedNumbers&)) {
    return {.id = id, .measure = measure, .judge = judge};
  }
  static std::vector<JudgedClaim> claims() {
    const Claim stiff = claim(
        "stiff",
        [](const Evidence& e) -> Measured {
          return {{"",
                   {{"stiffness", {e.load("springs_unlimited_mean").scenario.rendering.stiffness}},
                    {"force", {e.number("springs_unlimited_mean", "metrics.force_max_N")}}}}};
        },
        [](const Measured& m, const PublishedNumbers&) -> Finding {
          EXPECT_GT(m[0]["force"], 0.0);
          return {m[0]["stiffness"] > 20000.0 ? Verdict::reproduced : Verdict::in_kind, "", ""};
        });
    Claim costly = claim(
        "costly", [](const Evidence&) { return Measured(); },
        [](const Measured&, const PublishedNumbers&) -> Finding {
          return {Verdict::refuted, "", ""};
        });
    costly.costly = true;
    const Claim failing = claim(
        "failing",
        [](const Evidence& e) -> Measured {
          e.table("springs_unlimited_mean", "none.csv");
          return {};
        },
        [](const Measured&, const PublishedNumbers&) -> Finding { return {}; });
    return {{stiff, {Verdict::reproduced, "", ""}, {}, "reach"},
            {costly, {Verdict::refuted, "", ""}, {}, "reach"},
            {failing, {Verdict::reproduced, "", ""}, {}, "reach"}};
  }

  Readings readings(std::size_t count) const {
    std::string file = "stiffness,seed\n";
    for (std::size_t i = 0; i < count; ++i)
      file += std::to_string(0.5 + 1.5 * static_cast<double>(i * 7 % count) / static_cast<double>(count)) +
              (i % 2 == 0 ? ",2\n" : ",1\n");
    test::write_plainly(directory_ / "readings.csv", file);
    const Choices choices(directory_ / "choices.json");
    return {choices, {}, claims(), read_readings(directory_ / "readings.csv", choices)};
  }
  test::TemporaryDirectory directory_;
};

TEST_F(Robustness, JudgesEveryReadingByItsOwnChoices) {
  const Readings r = readings(6);
  std::vector<ReadingVerdicts> judged;
  for (std::size_t i = 0; i < 6; ++i) {
    const bool stiff = *finite_number(r.values[i][0]) > 1.0;
    judged.push_back(judge_reading(r, i, directory_ / "runs"));
    EXPECT_EQ(judged[i].verdicts,
              (std::vector<std::string>{stiff ? "reproduced" : "reproduced in kind", i < 2 ? "refuted" : "", "error"}));
    ASSERT_EQ(judged[i].problems.size(), 1u);
    EXPECT_NE(judged[i].problems[0].find("none.csv"), std::string::npos) << judged[i].problems[0];
  }
  EXPECT_FALSE(fs::exists(directory_ / "runs")) << "results are removed";
  const auto lines = test::lines_of(robustness_table(r, judged));
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_EQ(lines[0], "sample,stiffness,seed,stiff,costly,failing");
  EXPECT_EQ(lines[1], "0,0.500000,2,reproduced in kind,refuted,error");
}

TEST_F(Robustness, CountsAndNamesWhatDecides) {
  const Readings r = readings(64);
  std::vector<ReadingVerdicts> judged;
  for (std::size_t i = 0; i < 64; ++i)
    judged.push_back({{r.values[i][1] == "2" ? "reproduced" : "refuted", i < 16 ? "refuted" : "",
                       i % 2 == 0 ? "error" : "reproduced"},
                      {}});
  const Json record = robustness_json(r, judged, Json::object());
  EXPECT_EQ(record.at("costly_samples"), 16);
  const Json& claims = record.at("claims");
  ASSERT_EQ(claims.size(), 3u);
  EXPECT_EQ(claims[0].at("verdicts"), Json({{"refuted", 32}, {"reproduced", 32}}));
  EXPECT_EQ(claims[0].at("majority"), "reproduced") << "of two as frequent, the one on record";
  EXPECT_EQ(claims[0].at("decided_by"), Json({{"choice", "seed"}, {"index", 1.0}}));
  const auto counts = [&claims](std::size_t c) {
    std::vector<int> found;
    for (const char* key : {"judged", "holds", "reproduced", "not_measured"})
      found.push_back(claims[c].at(key).get<int>());
    return found;
  };
  EXPECT_EQ(counts(0), (std::vector<int>{64, 32, 32, 0}));
  EXPECT_EQ(counts(1), (std::vector<int>{16, 16, 0, 0}));
  EXPECT_TRUE(claims[1].at("decided_by").is_null()) << "it never changes";
  EXPECT_EQ(counts(2), (std::vector<int>{32, 32, 32, 32}));
  EXPECT_EQ(claims[2].at("verdicts"), Json({{"reproduced", 32}}));
}

TEST_F(Robustness, GoesIntoTheLedgerWhileItIsAboutTheSameChoicesAndVerdict) {
  Readings r = readings(4);
  const std::vector<ReadingVerdicts> judged(4, {{"reproduced", "refuted", "error"}, {}});
  const Json record = robustness_json(r, judged, Json::object());
  const JudgedClaim& same = r.claims[0];
  JudgedClaim other = same, untouched = same, moved = same;
  other.finding.verdict = Verdict::refuted;
  moved.reach = "another";
  untouched.reach = "";
  const auto on_record = [&record](const JudgedClaim& claim) {
    return Json(ledger_json({claim}, {}, record).at("claims").at(0).at("robustness"));
  };
  EXPECT_EQ(on_record(same).at("holds"), 4);
  EXPECT_EQ(on_record(same).at("majority"), "reproduced");
  EXPECT_TRUE(on_record(other).is_null()) << "the verdict has changed since";
  EXPECT_TRUE(on_record(moved).is_null()) << "the choices that reach it have changed since";
  EXPECT_TRUE(on_record(untouched).is_null()) << "readings say nothing of it";
  EXPECT_TRUE(test::input_error_of([&] { ledger_json({same}, {}, Json::object()); }));
  // A record of other claims keeps it.
  Readings none = r;
  none.claims.clear();
  EXPECT_EQ(robustness_json(none, {}, record).at("claims"), record.at("claims"));
}

using Bins = std::vector<std::size_t>;
using Values = std::vector<double>;

Values uniform(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  Values values(count);
  for (double& value : values) value = random.uniform();
  return values;
}

TEST(EqualCountBins, CutTheValuesInOrder) {
  EXPECT_EQ(equal_count_bins(Values{3, 1, 2, 4}, 2), (Bins{1, 0, 0, 1}));
  EXPECT_EQ(equal_count_bins(Values{5, 5, 5}, 3), (Bins{0, 1, 2}));
  EXPECT_TRUE(equal_count_bins(Values{}, 3).empty());
}

TEST(FirstOrderIndex, IsTheFormulasByHand) {
  // Means 0.25 and 1 about 0.625: SST = 1.875, SSB = 2 * 4 * 0.375^2 = 1.125, SSW = 0.75 with 8 - 2 degrees of freedom.
  const Bins bin = {0, 0, 0, 0, 1, 1, 1, 1};
  const Values y = {0, 0, 0, 1, 1, 1, 1, 1};
  EXPECT_NEAR(first_order_index(bin, y), (1.125 - 0.75 / 6.0) / 1.875, 1e-15);
  EXPECT_EQ(first_order_index(bin, Values{0, 0, 0, 0, 1, 1, 1, 1}), 1.0);
  EXPECT_TRUE(std::isnan(first_order_index(bin, Values(8, 1.0)))) << "nothing changes";
  EXPECT_TRUE(std::isnan(first_order_index(Bins{0, 1}, Values{0, 1}))) << "every bin has one point";
}

TEST(DecidingInput, IsTheOneThatDecidesOrNone) {
  constexpr std::size_t kPoints = 96;
  std::vector<Bins> bins;
  std::vector<Values> inputs;
  for (std::uint64_t i = 0; i < 10; ++i) {
    inputs.push_back(uniform(kPoints, 100 + i));
    bins.push_back(equal_count_bins(inputs.back(), 6));
  }
  Values y(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) y[i] = inputs[7][i] < 0.3 ? 1.0 : 0.0;
  const auto deciding = deciding_input(bins, y, 1);
  ASSERT_TRUE(deciding);
  EXPECT_EQ(deciding->input, 7u);
  EXPECT_GT(deciding->index, 0.8);
  EXPECT_FALSE(deciding_input(bins, Values(kPoints, 1.0), 1)) << "y never changes";
}

TEST(DecidingInput, RaisesFalseAlarmsAtItsLevelOnly) {
  constexpr std::size_t kPoints = 64, kTrials = 300;
  std::vector<Bins> bins;
  for (std::uint64_t i = 0; i < 10; ++i) bins.push_back(equal_count_bins(uniform(kPoints, 500 + i), 4));
  std::size_t alarms = 0;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    Values y = uniform(kPoints, 9000 + trial);
    for (double& value : y) value = value < 0.4 ? 1.0 : 0.0;
    if (deciding_input(bins, y, trial, 0.05, 99)) ++alarms;
  }
  // Binomial with p = 0.05: 15 of 300 on average, standard deviation 3.8.
  EXPECT_LE(alarms, 15u + 4 * 4);
  EXPECT_GE(alarms, 1u) << "the level is not that of something else";
}

}  // namespace
}  // namespace hapbench::choices_test
