#include "scenarios/program/describe/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <utility>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/text.hpp"

namespace hapbench {
namespace {

/// Returns true for an object whose fields are described one by one. An object with more than kMaxShown fields is not:
/// the object with the bounds on metrics has more fields than all other objects together.
bool shows_fields(const ValueGuide& value) {
  constexpr std::size_t kMaxShown = 50;
  return value.choices.empty() && !value.fields.empty() && value.fields.size() <= kMaxShown;
}

bool is_object(const ValueGuide& value) {
  return value.choices.empty() && value.schema.is_object() && value.schema.contains("properties");
}

/// Returns the default as JSON, with spaces where a line may break; empty if the field has no default.
std::string default_of(const FieldGuide& field) {
  std::string text;
  if (field.presence == Presence::has_default)
    for (const char c : shown(field.initial)) text += c == ',' ? ", " : std::string(1, c);
  return text;
}

/// Describes the fields of an object and of the objects in it. Each field has its dotted path from the outer
/// object, its allowed values, its default and its meaning.
std::string field_cards(const std::string& prefix, const ValueGuide& object, std::size_t indent, const Layout& layout) {
  std::string text;
  for (const FieldGuide& field : object.fields) {
    const bool nested = shows_fields(field.value);
    const std::string initial = nested ? "" : default_of(field);
    std::string facts = is_object(field.value) ? "" : field.value.allowed;
    if (!initial.empty()) facts += (facts.empty() ? "default " : "; default ") + initial;
    text += std::string(indent, ' ') + bold(stdout, prefix + field.name) + "\n";
    if (!facts.empty()) text += layout.wrapped(facts, indent + 4);
    if (!field.meaning.empty()) text += layout.wrapped(field.meaning, indent + 4);
    if (nested) text += field_cards(prefix + field.name + ".", field.value, indent, layout);
  }
  return text;
}

/// Describes a value below its title. An object shows its fields; a choice of types shows the fields of each
/// type; a plain value shows its allowed values and its default. `of` names the types or the field that the
/// value belongs to, if other values have the same title.
std::string value_text(const std::string& title, const std::string& of, const std::string& meaning,
                       const ValueGuide& value, const Layout& layout, const std::string& initial = "") {
  std::string text = bold(stdout, title) + "\n";
  if (!of.empty()) text += layout.wrapped("of " + of);
  if (!meaning.empty()) text += layout.wrapped(meaning);
  if (!is_object(value)) text += layout.wrapped("allowed: " + value.allowed);
  if (shows_fields(value)) return text + "\n" + field_cards("", value, 2, layout);
  if (is_object(value)) return value.fields.empty() ? text + "  no fields\n" : text;
  if (!initial.empty()) text += layout.wrapped("default: " + initial);
  for (const ValueGuide& type : value.choices) {
    text += fmt::format("\n  type \"{}\"{}{}\n{}", bold(stdout, type.type), type.summary.empty() ? "" : ": ",
                        type.summary, field_cards("", type, 6, layout));
  }
  return text;
}

/// Describes the types that a field such as "hand.type" selects from; returns an empty description for other
/// fields.
Description describe_types(const std::string& path, const Layout& layout) {
  const std::string end = std::string(".") + kTypeField;
  if (!path.ends_with(end)) return {};
  const std::string field = path.substr(0, path.size() - end.size());
  const FieldGuide* found = find_field(field);
  if (found == nullptr || found->value.choices.empty()) return {};
  std::string text =
      fmt::format("{}\n  selects the fields of {}; \"hapbench describe {}\" shows the fields of each type\n\n",
                  bold(stdout, path), field, field);
  for (const ValueGuide& type : found->value.choices)
    text += layout.entry(fmt::format("\"{}\"", type.type), type.summary, 4, 24);
  return {text, {{"field", path}, {"types", names_of(found->value.choices, &ValueGuide::type)}}};
}

}  // namespace

const FieldGuide* find_field(const std::string& path) {
  const std::vector<ScenarioField> all = scenario_fields();
  const auto found = std::ranges::find(all, path, &ScenarioField::path);
  return found == all.end() ? nullptr : found->field;
}

std::string field_unit(const std::string& path) {
  // The text of the allowed values ends with the unit, as in "a number > 0 and <= 10 [m]".
  const FieldGuide* field = find_field(path);
  if (field == nullptr || !field->value.allowed.ends_with(']')) return "1";
  const std::string& allowed = field->value.allowed;
  const std::size_t begin = allowed.rfind('[') + 1;
  return allowed.substr(begin, allowed.size() - begin - 1);
}

Description describe_field(const std::string& path, const Layout& layout) {
  if (Description types = describe_types(path, layout); !types.text.empty()) return types;
  // Group the types that share the schema of the field.
  std::vector<ScenarioField> found;
  for (const ScenarioField& placed : scenario_fields()) {
    if (placed.path != path) continue;
    const auto schema_of = [](const ScenarioField& other) { return other.field->schema(); };
    const auto same = std::ranges::find(found, placed.field->schema(), schema_of);
    if (same == found.end())
      found.push_back(placed);
    else
      same->types += (placed.types.empty() ? "" : ", ") + placed.types;
  }
  // Describe each group.
  std::vector<Description> meanings;
  for (const auto& [at, types, field] : found) {
    Json json = field->schema();
    if (!types.empty()) json["of"] = types;
    meanings.push_back(
        {value_text(at, types, field->meaning, field->value, layout, default_of(*field)), std::move(json)});
  }
  return joined(meanings);
}

Description describe_algorithms(const Layout& layout) {
  Description d = describe_field("rendering.algorithm", layout);
  d.text += layout.wrapped("\"hapbench describe algorithms\" lists them with summaries");
  return d;
}

Description describe_profile(const Layout& layout) {
  const FieldGuide& any = *find_field("motion.orientation.tilt_rad");  // its value is a function of time
  Json schema = any.schema();
  schema["description"] = "a function of time: a constant number, or an object";
  schema.erase("default");
  return {value_text("profile", "", schema["description"].get<std::string>(), any.value, layout), schema};
}

Description describe_scenario_fields(const Layout& layout) {
  const Json& schema = scenario_guide().schema;
  return {value_text("scenario", "", schema["description"].get<std::string>(), scenario_guide(), layout), schema};
}

void add_types(Index& index, const Layout& layout) {
  std::vector<std::pair<std::string, const ValueGuide*>> types;
  const auto schema_of = [](const auto& known) -> const Json& { return known.second->schema; };
  for (const ScenarioField& placed : scenario_fields())
    for (const ValueGuide& choice : placed.field->value.choices)
      if (std::ranges::find(types, choice.schema, schema_of) == types.end()) types.emplace_back(placed.path, &choice);
  for (const auto& [field, type] : types) {
    const auto has_the_name = [type = type](const auto& other) { return other.second->type == type->type; };
    const std::string of = std::ranges::count_if(types, has_the_name) > 1 ? field : "";
    index.push_back({field, type->type, type->summary, [type = type, of, layout] {
                       return Description{value_text(type->type, of, type->summary, *type, layout), type->schema};
                     }});
  }
}

}  // namespace hapbench
