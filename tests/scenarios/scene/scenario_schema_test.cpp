#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "sim/core/random.hpp"
#include "tests/scenarios/support/mutation.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/scenarios/support/schema_validator.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::scenario_schema_test {
namespace {

using test::NamedScenario;

// Tests that the reader and its JSON Schema agree about every document. An independent validator evaluates the schema.

const test::SchemaValidator& schema() {
  static const test::SchemaValidator validator(scenario_schema());
  return validator;
}

/// Returns the error of the reader; empty if the reader accepts the document.
std::optional<InputError> objection_to(const Json& document) {
  try {
    read_scenario(document, "");
    return std::nullopt;
  } catch (const InputError& error) {
    return error;
  }
}

/// Returns valid scenarios. rich_scenarios() come first, because they contain every field, while bundled scenarios are
/// similar to each other.
std::vector<NamedScenario> valid_scenarios() {
  std::vector<NamedScenario> all = test::rich_scenarios();
  for (const auto& more : {test::minimal_scenarios(), test::bundled_scenario_files()}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

/// Returns the number of mutants of the i-th valid scenario.
std::size_t mutants_of(std::size_t i) {
  return test::cases(i < test::rich_scenarios().size() ? 4000 : 300);
}

TEST(ScenarioSchema, InTheTreeIsTheOneTheProgramEmits) {
  const auto file = std::filesystem::path(HAPBENCH_SCENARIOS) / "scenario.schema.json";
  EXPECT_EQ(read_text_file(file, kMaxJsonFileBytes), json_text(scenario_schema()))
      << "regenerate it: hapbench describe schema > scenarios/library/scenario.schema.json";
}

TEST(ScenarioSchema, AcceptsEveryValidScenarioAndItsEffectiveForm) {
  for (const NamedScenario& scenario : valid_scenarios()) {
    EXPECT_EQ(schema().complaints(scenario.json), "") << scenario.name;
    const Json effective = effective_scenario(read_scenario(scenario.json, "").scenario, "");
    EXPECT_EQ(schema().complaints(effective), "") << scenario.name;
  }
}

TEST(ScenarioSchema, HasAnExampleInTheTestsForEveryField) {
  // The mutations below change only fields that occur in these scenarios, so every field must occur.
  std::set<std::string> seen, known;
  for (const NamedScenario& scenario : valid_scenarios()) {
    for (const std::string& at : test::pointers_in(scenario.json)) {
      if (!at.empty()) seen.insert(Json::json_pointer(at).back());
    }
  }
  const Json document = scenario_schema();
  for (const std::string& at : test::pointers_in(document)) {
    const Json::json_pointer pointer(at);
    if (!at.empty() && !pointer.parent_pointer().empty() && pointer.parent_pointer().back() == "properties" &&
        at.find("/metrics/") == std::string::npos && at.find("/default/") == std::string::npos) {
      known.insert(pointer.back());
    }
  }
  seen.insert("extends");  // a document in memory extends nothing; the tests below test "extends"
  seen.insert("config");  // a field of a library, which tests/data cannot contain; the tests of contact sources test it
  for (const std::string& field : known) EXPECT_TRUE(seen.contains(field)) << field;
}

TEST(ScenarioSchema, AcceptsFilesThatExtendOthersAsTheyStand) {
  std::size_t extending = 0;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const Json json = read_json(bundled.file);
    EXPECT_EQ(schema().complaints(json), "") << bundled.name;
    if (json.contains("extends")) ++extending;
  }
  EXPECT_GT(extending, 0u);
  const auto accepts = [](const char* text) { return schema().accepts(Json::parse(text)); };
  EXPECT_TRUE(accepts(R"({"extends": "poke_plane"})"));
  EXPECT_TRUE(accepts(R"({"extends": "poke_plane", "environment": {"size_m": 1}, "rendering": {"reduction": null}})"));
  EXPECT_FALSE(accepts(R"({"extends": 5})"));
  EXPECT_FALSE(accepts(R"({"extends": "poke_plane", "rendreing": {}})"));
  EXPECT_FALSE(accepts(R"({"extends": "poke_plane", "rendering": {"mass_kg": -1}})"));
  EXPECT_FALSE(accepts(R"({"environment": {"type": "plane"}})"));
}

/// Checks that schema and reader agree on a mutant; `objection` is the error of the reader.
void expect_agreement(const test::Mutation& mutant, const std::optional<InputError>& objection,
                      const std::string& name) {
  const bool accepted = schema().accepts(mutant.document);
  const bool wrong_shape = objection && objection->kind() == InputError::Kind::shape;
  EXPECT_EQ(wrong_shape, !accepted) << name << " " << mutant.change
                                    << "\n reader: " << (objection ? objection->what() : "fine")
                                    << "\n schema: " << schema().complaints(mutant.document);
  if (!objection) return;
  const std::string message = objection->what();
  EXPECT_EQ(message.find_first_of("\n\r"), std::string::npos) << name << " " << mutant.change;
  EXPECT_NE(message.find("allowed"), std::string::npos) << name << " " << mutant.change << ": " << message;
  // If the shape of the document is wrong, the location that the error names exists in the document. An error about
  // contradicting fields may name a field that the document does not contain, because the field has its default value.
  EXPECT_TRUE(!wrong_shape || mutant.document.contains(Json::json_pointer(objection->location_text()))) << message;
}

TEST(ScenarioSchema, RejectsExactlyTheMutantsWhoseShapeTheReaderRefuses) {
  Random random(2024);
  const std::vector<NamedScenario> scenarios = valid_scenarios();
  std::size_t refused = 0, related = 0, total = 0;
  for (std::size_t s = 0; s < scenarios.size(); ++s) {
    const std::size_t mutants = mutants_of(s);
    for (std::size_t i = 0; i < mutants && !HasFailure(); ++i, ++total) {
      const test::Mutation mutant = test::mutated(scenarios[s].json, random);
      const std::optional<InputError> objection = objection_to(mutant.document);
      expect_agreement(mutant, objection, scenarios[s].name);
      if (objection) ++(objection->kind() == InputError::Kind::shape ? refused : related);
    }
  }
  // Some mutants are valid and some are invalid, because otherwise the test would show little.
  EXPECT_GT(refused, total / 2);
  EXPECT_LT(refused, total * 9 / 10);
  EXPECT_GT(related, total / 1000);
}

TEST(ScenarioSchema, RejectsNothingThatTheReaderAcceptsAfterManyChanges) {
  // In a document with several faults, the reader may find a contradiction between fields before a wrong shape. The
  // schema must still accept every document that the reader accepts, and reject every document whose shape the reader
  // refuses.
  Random random(7);
  const std::size_t per_scenario = test::cases(150);
  for (const NamedScenario& scenario : valid_scenarios()) {
    for (std::size_t i = 0; i < per_scenario && !HasFailure(); ++i) {
      test::Mutation mutant{scenario.json, ""};
      for (int changes = 0; changes < 4; ++changes) mutant = test::mutated(mutant.document, random);
      const auto objection = objection_to(mutant.document);
      const bool accepted = schema().accepts(mutant.document);
      EXPECT_FALSE(!objection && !accepted) << mutant.document << schema().complaints(mutant.document);
      EXPECT_FALSE(objection && objection->kind() == InputError::Kind::shape && accepted)
          << mutant.document << objection->what();
    }
  }
}

}  // namespace
}  // namespace hapbench::scenario_schema_test
