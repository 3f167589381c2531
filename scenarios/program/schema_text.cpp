#include "scenarios/program/schema_text.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

const char* const kChoices[] = {"anyOf", "oneOf"};

std::string tag_of(const Json& schema) {
  const Json::json_pointer pointer("/properties/type/const");
  return schema.contains(pointer) ? schema.at(pointer).get<std::string>() : "";
}

/// An object with fields, or the choice within an anyOf/oneOf that has some.
const Json* with_properties(const Json& schema) {
  if (schema.contains("properties")) return &schema;
  for (const char* choices : kChoices) {
    if (!schema.contains(choices)) continue;
    for (const Json& choice : schema[choices]) {
      if (const Json* found = with_properties(choice)) return found;
    }
  }
  return nullptr;
}

/// The tagged object of that type, anywhere in the schema.
const Json* find_type(const Json& schema, const std::string& type) {
  if (!schema.is_structured()) return nullptr;
  if (schema.is_object() && tag_of(schema) == type) return &schema;
  for (const Json& part : schema) {
    if (const Json* found = find_type(part, type)) return found;
  }
  return nullptr;
}

/// The fields themselves: of an object, or of the object in "null or an object"; null for anything else.
const Json* plain_object(const Json& schema) {
  if (schema.contains("properties")) return &schema;
  if (!schema.contains("anyOf") || schema["anyOf"].size() != 2) return nullptr;
  const Json& second = schema["anyOf"][1];
  return second.contains("properties") && tag_of(second).empty() ? &second : nullptr;
}

/// A number without the ".0" that JSON gives to whole ones; any other value as JSON.
std::string bound_text(const Json& bound) {
  return bound.is_number_float() ? fmt::format("{:g}", bound.get<double>()) : bound.dump();
}

}  // namespace

std::string default_text(const Json& schema) {
  return schema.contains("default") ? bound_text(schema["default"]) : "by scene";
}

std::string allowed_text(const Json& schema) {
  if (schema.contains("enum")) return shown(schema["enum"]);
  if (const std::string tag = tag_of(schema); !tag.empty()) return "type \"" + tag + "\"";
  for (const char* choices : kChoices) {
    if (!schema.contains(choices) || schema.contains("properties")) continue;
    std::string text;
    for (const Json& choice : schema[choices]) text += (text.empty() ? "" : " | ") + allowed_text(choice);
    return text;
  }
  std::string text = schema.value("type", "anything");
  if (schema.contains("exclusiveMinimum")) text += fmt::format(" > {}", bound_text(schema["exclusiveMinimum"]));
  if (schema.contains("minimum")) text += fmt::format(" >= {}", bound_text(schema["minimum"]));
  if (schema.contains("maximum")) text += fmt::format(" <= {}", bound_text(schema["maximum"]));
  if (text.rfind("array", 0) == 0 && schema.contains("items") && schema["items"].is_object()) {
    text += " of " + allowed_text(schema["items"]);
  }
  return text;
}

namespace {

void add_fields(Table& table, const std::string& prefix, const Json& schema) {
  for (const auto& [name, field] : schema["properties"].items()) {
    if (field.contains("const")) continue;
    const Json* nested = plain_object(field);
    const bool is_object = nested == &field;
    const std::string initial = field.contains("default") && nested == nullptr ? shown(field["default"]) : "";
    table.add({prefix + name, initial, is_object ? "" : allowed_text(field), field.value("description", "")});
    if (nested != nullptr) add_fields(table, prefix + name + ".", *nested);
  }
}

}  // namespace

const Json& scenario_schema_once() {
  static const Json schema = full_scenario_schema();
  return schema;
}

const Json* find_in_schema(const Json& schema, const std::string& name) {
  if (name == "scenario") return &schema;
  const Json* node = &schema;
  for (std::size_t start = 0; node != nullptr && start != std::string::npos;) {
    const std::size_t dot = name.find('.', start);
    const std::string key = name.substr(start, dot == std::string::npos ? dot : dot - start);
    start = dot == std::string::npos ? dot : dot + 1;
    const Json* object = with_properties(*node);
    node = object != nullptr && (*object)["properties"].contains(key) ? &(*object)["properties"][key] : nullptr;
  }
  return node != nullptr || name.empty() ? node : find_type(schema, name);
}

std::string fields_text(const std::string& title, const Json& schema) {
  std::string text = title + "\n";
  if (schema.contains("description")) text += "  " + schema["description"].get<std::string>() + "\n";
  const Json* object = plain_object(schema);
  if (object != &schema) text += "  allowed: " + allowed_text(schema) + "\n";
  if (object == nullptr) {
    if (schema.contains("default")) text += "  default: " + shown(schema["default"]) + "\n";
    return text;
  }
  Table table({{"field", false}, {"default", false}, {"allowed", false}, {"meaning", false}});
  add_fields(table, "", *object);
  return text + "\n" + table.text();
}

namespace {

/// The choice of the schema that is an object of the value's type; null when the value is no object with fields.
const Json* object_of(const Json& value, const Json& schema) {
  if (!value.is_object()) return nullptr;
  if (schema.contains("properties")) {
    const std::string tag = tag_of(schema);
    return tag.empty() || value.value("type", "") == tag ? &schema : nullptr;
  }
  for (const char* choices : kChoices) {
    if (!schema.contains(choices)) continue;
    for (const Json& choice : schema[choices]) {
      if (const Json* found = object_of(value, choice)) return found;
    }
  }
  return nullptr;
}

void add_meanings(std::vector<FieldMeaning>& meanings, const std::string& prefix, const Json& value,
                  const Json& object) {
  for (const auto& entry : value.items()) {
    const Json& field = object["properties"][entry.key()];
    if (field.contains("const")) continue;
    meanings.push_back({prefix + entry.key(), field["description"]});
    if (const Json* nested = object_of(entry.value(), field))
      add_meanings(meanings, prefix + entry.key() + ".", entry.value(), *nested);
  }
}

}  // namespace

std::vector<FieldMeaning> field_meanings(const Json& scenario) {
  std::vector<FieldMeaning> meanings;
  add_meanings(meanings, "", scenario, scenario_schema_once());
  return meanings;
}

}  // namespace hapbench
