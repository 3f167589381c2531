#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/schema_text.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::parameter_docs_test {
namespace {

std::vector<const ModelInfo*> all_models() {
  std::vector<const ModelInfo*> models(stages().begin(), stages().end());
  for (const AlgorithmEntry& entry : algorithms()) models.push_back(entry.info);
  for (const DepthModelEntry& entry : depth_models()) models.push_back(entry.info);
  return models;
}

/// "/rendering/iterations" for "rendering.iterations"
Json::json_pointer pointer_to(std::string field) {
  for (char& c : field) c = c == '.' ? '/' : c;
  return Json::json_pointer("/" + field);
}

/// What the reader says when the field holds an object.
std::string refusal_of_an_object_in(const char* field) {
  Json json = test::minimal_scenario("plane");
  json[pointer_to(field)] = Json::object();
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  return error ? error->what() : "";
}

/// Parameters are documented with the models and enforced where scenarios are described.
TEST(ParameterBlocks, NameFieldsOfScenariosWithTheirUnits) {
  std::size_t checked = 0;
  for (const ModelInfo* model : all_models()) {
    for (const auto& [parameter, meaning] : model->parameters) {
      const std::string where = std::string(model->name) + ": " + parameter.field, unit = parameter.range.unit;
      ASSERT_NE(find_in_schema(scenario_schema_once(), parameter.field), nullptr) << where;
      const std::string refusal = refusal_of_an_object_in(parameter.field);
      EXPECT_EQ(refusal.find(pointer_to(parameter.field).to_string() + ": got {}"), 0u) << refusal;
      const bool is_number = refusal.find("a number") != std::string::npos;
      EXPECT_TRUE(is_number ? refusal.find("[" + unit + "]") != std::string::npos : unit == "1") << where << refusal;
      EXPECT_STRNE(meaning, "") << where;
      ++checked;
    }
  }
  EXPECT_GE(checked, 18u);
}

TEST(DefaultText, IsThatOfTheSchemaOrSaysThatTheSceneGivesIt) {
  const auto text = [](const char* field) { return default_text(*find_in_schema(scenario_schema_once(), field)); };
  EXPECT_EQ(text("rendering.stiffness_N_per_m"), "20000");
  EXPECT_EQ(text("rendering.iterations"), "3");
  EXPECT_EQ(text("rendering.damping_ratio"), "0.7");
  EXPECT_EQ(text("rendering.reduction.threshold"), "0.995");
  EXPECT_EQ(text("rendering.limits.max_force_N"), "null");
  EXPECT_EQ(text("rendering.angular_damping"), "false");
  EXPECT_EQ(text("rendering.mass_kg"), "by scene");
}

TEST(RangeText, IsThatOfTheSchema) {
  const auto text = [](const char* field) { return allowed_text(*find_in_schema(scenario_schema_once(), field)); };
  EXPECT_EQ(text("rendering.reduction.threshold"), "number > -1 <= 1");
  EXPECT_EQ(text("rendering.reduction.shuffle_seed"), "null | integer >= 0 <= 9007199254740992");
  EXPECT_EQ(text("rendering.mass_kg"), "number > 0 <= 1e+06");
  EXPECT_EQ(text("rendering.local_average"), "boolean");
}

}  // namespace
}  // namespace hapbench::parameter_docs_test
