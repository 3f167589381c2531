#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "scenarios/program/schema_text.hpp"

namespace hapbench {
namespace {

std::vector<const ModelInfo*> all_models() {
  std::vector<const ModelInfo*> models(stages().begin(), stages().end());
  for (const AlgorithmEntry& entry : algorithms()) models.push_back(entry.info);
  for (const DepthModelEntry& entry : depth_models()) models.push_back(entry.info);
  return models;
}

/// The parameter blocks at the top of the model files are written by hand; the schema comes from what the reader
/// enforces. They must say the same.
TEST(ParameterBlocks, AgreeWithTheFieldsTheReaderEnforces) {
  std::size_t checked = 0;
  for (const ModelInfo* model : all_models()) {
    for (const ParameterInfo& parameter : model->parameters) {
      const std::string where = std::string(model->name) + ": " + parameter.name;
      const Json* field = find_in_schema(scenario_schema_once(), parameter.name);
      ASSERT_NE(field, nullptr) << where;
      EXPECT_EQ(parameter.range, allowed_text(*field)) << where;
      const std::string given = parameter.default_value;
      // A default that depends on the scene is said in the meaning, and the schema has none.
      ASSERT_EQ(given == "by scene", !field->contains("default")) << where;
      if (given != "by scene") {
        EXPECT_EQ(Json::parse(given), (*field)["default"]) << where;
      }
      ++checked;
    }
  }
  EXPECT_GE(checked, 18u);
}

}  // namespace
}  // namespace hapbench
