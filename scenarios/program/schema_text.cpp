#include "scenarios/program/schema_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "algorithms/registry.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/schema_writer.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

const char* const kChoices[] = {"anyOf", "oneOf"};

std::string tag_of(const Json& schema) {
  const Json::json_pointer pointer("/properties/type/const");
  return schema.contains(pointer) ? schema.at(pointer).get<std::string>() : "";
}

/// The field of that name, of an object or of the first choice within an anyOf/oneOf that has it.
const Json* field_in(const Json& schema, const std::string& name) {
  if (schema.contains("properties")) {
    const Json& fields = schema["properties"];
    return fields.contains(name) ? &fields[name] : nullptr;
  }
  for (const char* choices : kChoices) {
    if (!schema.contains(choices)) continue;
    for (const Json& choice : schema[choices]) {
      if (const Json* found = field_in(choice, name)) return found;
    }
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

/// A value as JSON with blanks where a line may end.
std::string spaced(const Json& value) {
  std::string text;
  for (const char c : shown(value)) text += c == ',' ? ", " : std::string(1, c);
  return text;
}

}  // namespace

std::string default_text(const Json& schema) {
  return schema.contains("default") ? bound_text(schema["default"]) : "by scene";
}

std::string allowed_text(const Json& schema) {
  if (schema.contains("enum")) {
    std::string text;
    for (const Json& word : schema["enum"]) text += (text.empty() ? "" : " | ") + word.get<std::string>();
    return text;
  }
  if (const std::string tag = tag_of(schema); !tag.empty()) return "type \"" + tag + "\"";
  for (const char* choices : kChoices) {
    if (!schema.contains(choices) || schema.contains("properties")) continue;
    std::string text, types;
    for (const Json& choice : schema[choices]) {
      const std::string tag = tag_of(choice);
      std::string& part = tag.empty() ? text : types;
      part += (part.empty() ? "" : tag.empty() ? " | " : ", ") + (tag.empty() ? allowed_text(choice) : tag);
    }
    if (types.empty()) return text;
    return (text.empty() ? "" : text + " | ") + "object of type " + types;
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

/// The plain object whose fields are told one by one: not the bounds on metrics, which are more than all other fields
/// together.
const Json* shown_object(const Json& schema) {
  return &schema == find_in_schema(scenario_schema_once(), "expect.metrics") ? nullptr : plain_object(schema);
}

/// The fields of an object and of those in it, each by its path from there.
std::string field_cards(const std::string& prefix, const Json& schema, std::size_t indent) {
  std::string text;
  for (const auto& [name, field] : schema["properties"].items()) {
    if (field.contains("const")) continue;
    const Json* nested = shown_object(field);
    const std::string initial = field.contains("default") && nested == nullptr ? spaced(field["default"]) : "";
    text +=
        card({prefix + name, "", initial, nested == &field ? "" : allowed_text(field), field.value("description", "")},
             indent);
    if (nested != nullptr) text += field_cards(prefix + name + ".", *nested, indent);
  }
  return text;
}

/// The tagged objects among which a value chooses.
std::vector<const Json*> types_in(const Json& schema) {
  if (!tag_of(schema).empty()) return {&schema};
  std::vector<const Json*> types;
  for (const char* choices : kChoices) {
    if (!schema.contains(choices) || schema.contains("properties")) continue;
    for (const Json& choice : schema[choices]) {
      const std::vector<const Json*> more = types_in(choice);
      types.insert(types.end(), more.begin(), more.end());
    }
  }
  return types;
}

struct TypeSummary {
  const char* type;
  const char* summary;
  const char* field = "";  ///< that it is a type of, where another field has a type of that name
};

constexpr TypeSummary kTypeSummaries[] = {
    {"springs", "springs on the tool's tip, without a surface"},
    {"hole_2d", "a hole in the plane, with its mouth"},
    {"plane", "a flat square"},
    {"slot", "two parallel faces"},
    {"conical_hole", "a hole that tapers to a point"},
    {"block_with_hole", "a block with a round blind hole, its shell by marching cubes"},
    {"point_shell", "points with normals from a CSV or PLY file"},
    {"mesh", "a surface from an OBJ, PLY, STL or OFF file"},
    {"cylinder", "a drill's stylus with a flat or a round tip"},
    {"revolved", "a solid of revolution, given by its profile"},
    {"bur", "a dental or bone bur by the name of its shape, with its shank"},
    {"none", "nobody: the tool moves by the rendered force alone"},
    {"force", "a force over time"},
    {"push", "a force over time along a direction that leans from straight down"},
    {"impedance", "a spring and damper towards a moving target", "hand"},
    {"impedance", "measures positions and renders forces: a light handle with motors, as most desktop devices",
     "device"},
    {"mass_spring_damper", "a passive hand fixed to the handle of an impedance device"},
    {"difference", "the last two positions over the time between them"},
    {"low_pass", "the difference through a first-order low-pass"},
    {"adaptive_window", "slope over the longest window that fits a straight line (Janabi-Sharifi et al. 2000)"},
    {"drag", "leads the tool over the surface, pressing along its normal"},
    {"tracking", "a simulated subject who follows targets on a display"},
    {"ideal", "measures and pushes without error"},
    {"admittance", "the thesis's device: force sensor, limiter and servo"},
    {"ramp", "a value that grows at a constant rate"},
    {"sine", "an oscillation about a value"},
    {"waypoints", "values at times, joined by straight lines or cosines"},
};

}  // namespace

const char* type_summary(std::string_view type, std::string_view field) {
  for (const TypeSummary& known : kTypeSummaries) {
    if (known.type == type && (*known.field == '\0' || known.field == field)) return known.summary;
  }
  return nullptr;
}

std::vector<std::string> type_names(const std::string& field) {
  std::vector<std::string> names;
  for (const Json* type : types_in(*find_in_schema(scenario_schema_once(), field))) names.push_back(tag_of(*type));
  return names;
}

const Json& scenario_schema_once() {
  static std::size_t built_after = additions();
  static Json schema = full_scenario_schema();
  if (std::exchange(built_after, additions()) != additions()) schema = full_scenario_schema();
  return schema;
}

const Json* find_in_schema(const Json& schema, const std::string& name) {
  if (name == "scenario") return &schema;
  const Json* node = &schema;
  for (std::size_t start = 0; node != nullptr && start != std::string::npos;) {
    const std::size_t dot = name.find('.', start);
    const std::string key = name.substr(start, dot == std::string::npos ? dot : dot - start);
    start = dot == std::string::npos ? dot : dot + 1;
    node = field_in(*node, key);
  }
  return node;
}

namespace {

/// `at` is the path of the schema with a dot behind it.
void find_types(const Json& schema, const std::string& at, const std::string& type, std::vector<TypedField>& found) {
  if (!schema.is_object()) return;
  if (schema.contains("properties")) {
    for (const auto& [name, field] : schema["properties"].items()) {
      for (const Json* one : types_in(field)) {
        const auto same = [one](const TypedField& known) { return *known.schema == *one; };
        if (tag_of(*one) == type && std::none_of(found.begin(), found.end(), same)) found.push_back({at + name, one});
      }
      find_types(field, at + name + ".", type, found);
    }
    return;
  }
  for (const char* choices : kChoices) {
    if (!schema.contains(choices)) continue;
    for (const Json& choice : schema[choices]) find_types(choice, at, type, found);
  }
}

}  // namespace

std::vector<TypedField> types_called(const Json& schema, const std::string& type) {
  std::vector<TypedField> found;
  find_types(schema, "", type, found);
  return found;
}

namespace {

/// `at` is the path of the schema with a dot behind it, `types` what leads there.
void find_fields(const Json& schema, const std::string& at, const std::string& path, const std::string& types,
                 std::vector<TypedField>& found) {
  if (!schema.contains("properties")) {
    for (const char* choices : kChoices) {
      if (!schema.contains(choices)) continue;
      for (const Json& choice : schema[choices]) find_fields(choice, at, path, types, found);
    }
    return;
  }
  const std::size_t dot = path.find('.');
  const std::string key = path.substr(0, dot), tag = tag_of(schema);
  if (!schema["properties"].contains(key)) return;
  const Json& field = schema["properties"][key];
  const std::string type = tag.empty() ? "" : fmt::format("{}type \"{}\"", at, tag);
  const std::string all = types + (types.empty() || type.empty() ? "" : " and ") + type;
  if (dot != std::string::npos) return find_fields(field, at + key + ".", path.substr(dot + 1), all, found);
  const auto same = std::find_if(found.begin(), found.end(), [&field](const auto& f) { return *f.schema == field; });
  if (same == found.end()) {
    found.push_back({all, &field});
  } else {
    same->types += (all.empty() ? "" : ", ") + all;
  }
}

}  // namespace

std::vector<TypedField> typed_fields(const Json& schema, const std::string& path) {
  std::vector<TypedField> found;
  find_fields(schema, "", path, "", found);
  return found;
}

std::string types_text(const std::string& type_field) {
  const std::string end = std::string(".") + kTypeField;
  if (!type_field.ends_with(end)) return "";
  const std::string field = type_field.substr(0, type_field.size() - end.size());
  if (find_in_schema(scenario_schema_once(), field) == nullptr) return "";
  std::string text;
  for (const std::string& type : type_names(field)) {
    const char* summary = type_summary(type, field);
    text += entry(fmt::format("\"{}\"", type), summary != nullptr ? summary : "", 4, 24);
  }
  if (text.empty()) return "";
  return fmt::format("{}\n  chooses the fields of {}; \"hapbench describe {}\" shows those of each\n\n{}",
                     bold(stdout, type_field), field, field, text);
}

std::string card(const FieldCard& field, std::size_t indent) {
  std::string facts = field.allowed;
  if (!field.unit.empty()) facts += fmt::format(" [{}]", field.unit);
  if (!field.initial.empty()) facts += (facts.empty() ? "default " : "; default ") + field.initial;
  std::string text = std::string(indent, ' ') + bold(stdout, field.name) + "\n";
  if (!facts.empty()) text += wrapped(facts, indent + 4);
  return field.meaning.empty() ? text : text + wrapped(field.meaning, indent + 4);
}

std::string fields_text(const std::string& title, const Json& schema, const std::string& types) {
  std::string text = bold(stdout, title) + "\n";
  if (!types.empty()) text += wrapped("of " + types);
  if (const char* summary = type_summary(title, types)) text += wrapped(summary);
  if (schema.contains("description")) text += wrapped(schema["description"].get<std::string>());
  const Json* object = shown_object(schema);
  if (object != &schema) text += wrapped("allowed: " + allowed_text(schema));
  if (object != nullptr) {
    const std::string cards = field_cards("", *object, 2);
    return cards.empty() ? text + "  no fields\n" : text + "\n" + cards;
  }
  if (schema.contains("default")) text += wrapped("default: " + spaced(schema["default"]));
  for (const Json* type : types_in(schema)) {
    const std::string tag = tag_of(*type);
    const char* summary = type_summary(tag, title);
    text += fmt::format("\n  type \"{}\"{}{}\n{}", bold(stdout, tag), summary != nullptr ? ": " : "",
                        summary != nullptr ? summary : "", field_cards("", *type, 6));
  }
  return text;
}

namespace {

/// What the object's "type" says; the type itself where it need not be said.
std::string type_of(const Json& value, const Json& schema) {
  const Json required = schema.value("required", Json::array());
  const bool said = std::find(required.begin(), required.end(), "type") != required.end();
  return value.value("type", said ? "" : tag_of(schema));
}

/// The choice of the schema that is an object of the value's type; null when the value is no object with fields.
const Json* object_of(const Json& value, const Json& schema) {
  if (!value.is_object()) return nullptr;
  if (schema.contains("properties")) {
    const std::string tag = tag_of(schema);
    return tag.empty() || type_of(value, schema) == tag ? &schema : nullptr;
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
