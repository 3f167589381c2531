#include "scenarios/scene/merge_scenarios.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/scenario_schema.hpp"

namespace hapbench {
namespace {

/// Pairs of a field and the field that it excludes. Each pair is listed in both orders.
constexpr std::pair<std::string_view, const char*> kExclusiveFields[] = {
    {"steps", "duration_s"}, {"duration_s", "steps"},      {"path_m", "direction"},
    {"direction", "path_m"}, {"delay_s", "delay_samples"}, {"delay_samples", "delay_s"}};

/// Returns the type that an object at a dotted path has if its field "type" is missing; empty if the field is required.
std::string untyped_type(const std::string& path) {
  for (const ScenarioField& placed : scenario_fields()) {
    if (placed.path != path) continue;
    for (const ValueGuide& choice : placed.field->value.choices)
      if (choice.may_be_untyped) return choice.type;
  }
  return "";
}

/// Returns true if `more` names another type than `base` has.
bool has_other_type(const Json& base, const Json& more, const std::string& path) {
  if (!more.is_object() || !more.contains(kTypeField)) return false;
  if (base.is_object() && base.contains(kTypeField)) return base[kTypeField] != more[kTypeField];
  return more[kTypeField] != untyped_type(path);
}

/// Merges the objects at a dotted path, which is empty for the scenario.
void merge_at(Json& base, const Json& more, const std::string& path) {
  if (!base.is_object() || !more.is_object() || has_other_type(base, more, path)) {
    base = more;
    return;
  }
  for (const auto& entry : more.items()) drop_alternative(base, entry.key());
  for (const auto& entry : more.items())
    merge_at(base[entry.key()], entry.value(), path.empty() ? entry.key() : path + "." + entry.key());
}

}  // namespace

void drop_alternative(Json& object, std::string_view field) {
  for (const auto& [given, other] : kExclusiveFields)
    if (given == field) object.erase(other);
}

void merge_fields(Json& base, const Json& more) {
  merge_at(base, more, "");
}

void drop_derived_samples(Json& scenario) {
  if (scenario.contains(Json::json_pointer("/device/delay_s"))) scenario["device"].erase("delay_samples");
}

}  // namespace hapbench
