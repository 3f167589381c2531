#include "scenarios/program/fields_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

/// A value as JSON with blanks where a line may end.
std::string spaced(const Json& value) {
  std::string text;
  for (const char c : shown(value)) text += c == ',' ? ", " : std::string(1, c);
  return text;
}

/// A field of scenarios, and the types that lead to it.
struct PlacedField {
  std::string path, types;
  const FieldGuide* field;
};

/// Adds the fields of an object and of those in it. `at` is the path of the object with a dot behind it.
void add_fields(std::vector<PlacedField>& all, const ValueGuide& object, const std::string& at,
                const std::string& types) {
  for (const ValueGuide& choice : object.choices) add_fields(all, choice, at, types);
  const std::string type = object.type.empty() ? "" : fmt::format("{}type \"{}\"", at, object.type);
  const std::string of = types + (types.empty() || type.empty() ? "" : " and ") + type;
  for (const FieldGuide& field : object.fields) {
    all.push_back({at + field.name, of, &field});
    add_fields(all, field.value, at + field.name + ".", of);
  }
}

/// Those of all scenarios, found anew when laws from outside have added theirs.
const std::vector<PlacedField>& all_fields() {
  thread_local const ValueGuide* guide = nullptr;
  thread_local std::vector<PlacedField> all;
  if (guide == &scenario_guide()) return all;
  guide = &scenario_guide();
  all.clear();
  add_fields(all, *guide, "", "");
  return all;
}

/// True for an object whose fields are told one by one: not the bounds on metrics, which are more than all others.
bool shows_fields(const ValueGuide& value) {
  constexpr std::size_t kMostShown = 50;
  return value.choices.empty() && !value.fields.empty() && value.fields.size() <= kMostShown;
}

bool is_object(const ValueGuide& value) {
  return value.choices.empty() && value.schema.is_object() && value.schema.contains("properties");
}

/// The fields of an object and of those in it, each by its path from there.
std::string field_cards(const std::string& prefix, const ValueGuide& object, std::size_t indent) {
  std::string text;
  for (const FieldGuide& field : object.fields) {
    const bool nested = shows_fields(field.value);
    const bool shows_default = field.presence == Presence::has_default && !nested;
    text += card({.name = prefix + field.name,
                  .initial = shows_default ? spaced(field.initial) : "",
                  .allowed = is_object(field.value) ? "" : field.value.allowed,
                  .meaning = field.meaning},
                 indent);
    if (nested) text += field_cards(prefix + field.name + ".", field.value, indent);
  }
  return text;
}

std::string body_text(const std::string& heading, const ValueGuide& value, const std::string& initial) {
  std::string text = heading;
  if (!is_object(value)) text += wrapped("allowed: " + value.allowed);
  if (shows_fields(value)) return text + "\n" + field_cards("", value, 2);
  if (is_object(value)) return value.fields.empty() ? text + "  no fields\n" : text;
  if (!initial.empty()) text += wrapped("default: " + initial);
  for (const ValueGuide& type : value.choices) {
    text += fmt::format("\n  type \"{}\"{}{}\n{}", bold(stdout, type.type), type.summary.empty() ? "" : ": ",
                        type.summary, field_cards("", type, 6));
  }
  return text;
}

/// The object of the value's type; null when the value is no object with fields.
const ValueGuide* object_of(const Json& value, const ValueGuide& guide) {
  if (!value.is_object()) return nullptr;
  if (guide.choices.empty()) return &guide;
  for (const ValueGuide& choice : guide.choices) {
    if (value.value(kTypeField, choice.may_be_untyped ? choice.type : "") == choice.type) return &choice;
  }
  return nullptr;
}

using FieldMeanings = std::vector<std::pair<std::string, std::string>>;

void add_meanings(FieldMeanings& meanings, const std::string& prefix, const Json& value, const ValueGuide& object) {
  for (const auto& entry : value.items()) {
    const auto field = std::ranges::find(object.fields, entry.key(), &FieldGuide::name);
    if (field == object.fields.end()) continue;  // the type
    meanings.emplace_back(prefix + entry.key(), field->meaning);
    if (const ValueGuide* nested = object_of(entry.value(), field->value))
      add_meanings(meanings, prefix + entry.key() + ".", entry.value(), *nested);
  }
}

}  // namespace

std::vector<TypedField> typed_fields(const std::string& path) {
  std::vector<TypedField> found;
  for (const auto& [of, types, field] : all_fields()) {
    if (of != path) continue;
    const auto same = [field = field](const TypedField& known) { return known.field->schema() == field->schema(); };
    const auto known = std::ranges::find_if(found, same);
    if (known == found.end()) {
      found.push_back({types, field});
    } else {
      known->types += (types.empty() ? "" : ", ") + types;
    }
  }
  return found;
}

const FieldGuide* find_field(const std::string& path) {
  const auto found = std::ranges::find(all_fields(), path, &PlacedField::path);
  return found == all_fields().end() ? nullptr : found->field;
}

std::vector<std::string> type_names(const std::string& field) {
  std::vector<std::string> names;
  if (const FieldGuide* found = find_field(field))
    for (const ValueGuide& type : found->value.choices) names.push_back(type.type);
  return names;
}

std::vector<FieldType> all_types() {
  std::vector<FieldType> found;
  for (const PlacedField& placed : all_fields()) {
    for (const ValueGuide& choice : placed.field->value.choices) {
      const auto same = [&choice](const FieldType& known) {
        return known.type->type == choice.type && known.type->schema == choice.schema;
      };
      if (std::ranges::none_of(found, same)) found.push_back({placed.path, &choice});
    }
  }
  return found;
}

std::string default_text(const FieldGuide& field) {
  if (field.presence != Presence::has_default) return "by scene";
  return field.initial.is_number_float() ? fmt::format("{:g}", field.initial.get<double>()) : field.initial.dump();
}

std::string card(const FieldCard& field, std::size_t indent) {
  std::string facts = field.allowed;
  if (!field.initial.empty()) facts += (facts.empty() ? "default " : "; default ") + field.initial;
  std::string text = std::string(indent, ' ') + bold(stdout, field.name) + "\n";
  if (!facts.empty()) text += wrapped(facts, indent + 4);
  return field.meaning.empty() ? text : text + wrapped(field.meaning, indent + 4);
}

std::string fields_text(const std::string& title, const ValueGuide& value, const std::string& of) {
  std::string heading = bold(stdout, title) + "\n";
  if (!of.empty()) heading += wrapped("of " + of);
  if (!value.summary.empty()) heading += wrapped(value.summary);
  if (value.schema.contains("description")) heading += wrapped(value.schema["description"].get<std::string>());
  return body_text(heading, value, "");
}

std::string fields_text(const std::string& title, const FieldGuide& field, const std::string& of) {
  std::string heading = bold(stdout, title) + "\n";
  if (!of.empty()) heading += wrapped("of " + of);
  heading += wrapped(field.meaning);
  return body_text(heading, field.value, field.presence == Presence::has_default ? spaced(field.initial) : "");
}

std::string types_text(const std::string& type_field) {
  const std::string end = std::string(".") + kTypeField;
  if (!type_field.ends_with(end)) return "";
  const std::string field = type_field.substr(0, type_field.size() - end.size());
  const FieldGuide* found = find_field(field);
  if (found == nullptr || found->value.choices.empty()) return "";
  std::string text;
  for (const ValueGuide& type : found->value.choices)
    text += entry(fmt::format("\"{}\"", type.type), type.summary, 4, 24);
  return fmt::format("{}\n  chooses the fields of {}; \"hapbench describe {}\" shows those of each\n\n{}",
                     bold(stdout, type_field), field, field, text);
}

FieldMeanings field_meanings(const Json& scenario) {
  FieldMeanings meanings;
  add_meanings(meanings, "", scenario, scenario_guide());
  return meanings;
}

}  // namespace hapbench
