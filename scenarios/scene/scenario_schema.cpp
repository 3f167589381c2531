#include "scenarios/scene/scenario_schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <mutex>

#include "algorithms/registry.hpp"
#include "scenarios/input/json_schema.hpp"
#include "scenarios/scene/describe_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench {
namespace {

/// Returns the documentation of a scenario that extends no other scenario. `definitions` is passed to guide_to.
ValueGuide full_scenario(Json* definitions) {
  Scenario defaults;
  ValueGuide guide = guide_to([&defaults](Fields& f) { f.object(defaults); }, definitions);
  Json schema = {
      {"description",
       "All values have SI units; the unit is part of a field's name. A profile is a scalar function of time."}};
  schema.update(guide.schema);
  guide.schema = std::move(schema);
  return guide;
}

/// Returns true if no field inside the schema is required. A valid object then stays valid if some of its fields are
/// removed.
bool allows_parts(const Json& schema) {
  if (!schema.is_structured()) return true;
  if (schema.is_object() && (schema.contains("required") || schema.contains("oneOf"))) return false;
  return std::all_of(schema.begin(), schema.end(), allows_parts);
}

/// Returns the schema of a file that extends another file (the base file). The file may omit any field. The meaning of
/// some fields depends on the base file, for example if only the base file has the type of their object. The schema
/// checks only fields whose meaning does not depend on the base file. `at` is the reference to the schema `full`, of a
/// file that extends no other file.
Json partial_schema(const ValueGuide& full, const std::string& at) {
  Json schema = {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
  for (const FieldGuide& field : full.fields) {
    Json& part = schema["properties"][field.name];
    const Json& whole = field.value.schema;
    // If nothing is required, use the same schema. For an object with required parts, recurse. Otherwise allow any
    // value.
    if (allows_parts(whole)) {
      part = {{"$ref", at + "/properties/" + field.name}};
    } else if (whole.contains("properties") && !whole.contains("required") && !whole.contains("oneOf")) {
      part = partial_schema(field.value, at + "/properties/" + field.name);
      part["description"] = field.meaning;
    } else {
      part = {{"description", field.meaning}};
    }
  }
  return schema;
}

/// Appends the fields of an object and, recursively, the fields of the objects in it. `at` is the object's dotted
/// path, with a dot at the end unless it is empty. The object exists only under the condition `types`, such as
/// `hand.type "drag"`; an empty condition is always true.
void add_fields(std::vector<ScenarioField>& all, const ValueGuide& object, const std::string& at,
                const std::string& types) {
  for (const ValueGuide& choice : object.choices) add_fields(all, choice, at, types);
  const std::string type = object.type.empty() ? "" : fmt::format("{}type \"{}\"", at, object.type);
  const std::string of = types + (types.empty() || type.empty() ? "" : " and ") + type;
  for (const FieldGuide& field : object.fields) {
    all.push_back({at + field.name, of, &field});
    add_fields(all, field.value, at + field.name + ".", of);
  }
}

}  // namespace

const ValueGuide& scenario_guide() {
  static std::mutex mutex;
  static std::deque<ValueGuide> built;
  static std::size_t known = 0;  // value of additions() when the last guide was built
  const std::lock_guard lock(mutex);
  if (built.empty() || known != additions()) built.push_back(full_scenario(nullptr));
  known = additions();
  return built.back();
}

std::vector<ScenarioField> scenario_fields() {
  std::vector<ScenarioField> all;
  add_fields(all, scenario_guide(), "", "");
  return all;
}

std::vector<std::string> scenario_field_paths() {
  std::vector<std::string> paths;
  const auto add = [&paths](const std::string& path) {
    if (std::ranges::find(paths, path) == paths.end()) paths.push_back(path);
  };
  for (const ScenarioField& placed : scenario_fields()) {
    add(placed.path);
    if (!placed.field->value.choices.empty()) add(placed.path + "." + kTypeField);
  }
  return paths;
}

Json scenario_schema() {
  Json definitions = Json::object();
  Json full = full_scenario(&definitions).schema;
  return {{"$schema", "http://json-schema.org/draft-07/schema#"},
          {"title", "hapbench scenario"},
          {"definitions", std::move(definitions)},
          {"if", {{"required", {kExtends}}}},
          {"then", partial_schema(scenario_guide(), "#/else")},
          {"else", std::move(full)}};
}

}  // namespace hapbench
