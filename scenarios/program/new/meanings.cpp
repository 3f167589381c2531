#include "scenarios/program/new/meanings.hpp"

#include <algorithm>
#include <string>

#include "scenarios/scene/scenario_schema.hpp"

namespace hapbench {
namespace {

/// Returns the description of the type that a value selects; null if the value is not an object with fields.
const ValueGuide* object_of(const Json& value, const ValueGuide& guide) {
  if (!value.is_object()) return nullptr;
  if (guide.choices.empty()) return &guide;
  for (const ValueGuide& choice : guide.choices)
    if (value.value(kTypeField, choice.may_be_untyped ? choice.type : "") == choice.type) return &choice;
  return nullptr;
}

/// Adds the meaning of each field in `value` to `meanings`, with the dotted path of the field as key. Objects come
/// before their fields.
void add_meanings(Json& meanings, const std::string& prefix, const Json& value, const ValueGuide& object) {
  for (const auto& entry : value.items()) {
    const auto field = std::ranges::find(object.fields, entry.key(), &FieldGuide::name);
    if (field == object.fields.end()) continue;  // the field "type" has no meaning of its own
    meanings[prefix + entry.key()] = field->meaning;
    if (const ValueGuide* nested = object_of(entry.value(), field->value))
      add_meanings(meanings, prefix + entry.key() + ".", entry.value(), *nested);
  }
}

}  // namespace

Json field_meanings(const Json& scenario) {
  Json meanings = Json::object();
  add_meanings(meanings, "", scenario, scenario_guide());
  return meanings;
}

}  // namespace hapbench
