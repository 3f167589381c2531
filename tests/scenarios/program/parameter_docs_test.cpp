#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/fields_text.hpp"
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
      ASSERT_NE(find_field(parameter.field), nullptr) << where;
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
  const auto text = [](const char* field) { return default_text(*find_field(field)); };
  EXPECT_EQ(text("rendering.stiffness_N_per_m"), "20000");
  EXPECT_EQ(text("rendering.iterations"), "3");
  EXPECT_EQ(text("rendering.damping_ratio"), "0.7");
  EXPECT_EQ(text("rendering.reduction.threshold"), "0.995");
  EXPECT_EQ(text("rendering.limits.max_force_N"), "null");
  EXPECT_EQ(text("rendering.angular_damping"), "false");
  EXPECT_EQ(text("rendering.mass_kg"), "by scene");
}

/// Messages and documentation say in the same words what a field may hold.
TEST(AllowedText, IsThatOfTheRefusal) {
  for (const char* field : {"rendering.reduction.threshold", "rendering.mass_kg", "rendering.local_average",
                            "rendering.algorithm", "seed"}) {
    const std::string allowed = "; allowed: " + find_field(field)->value.allowed;
    EXPECT_NE(refusal_of_an_object_in(field).find(allowed), std::string::npos) << allowed;
  }
  EXPECT_EQ(find_field("rendering.reduction.threshold")->value.allowed, "a number > -1 and <= 1 [1]");
  EXPECT_EQ(find_field("rendering.reduction.shuffle_seed")->value.allowed, "null or an integer 0 ... 9007199254740992");
}

}  // namespace
}  // namespace hapbench::parameter_docs_test
