#include "scenarios/scene/merge_scenarios.hpp"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "scenarios/input/fields.hpp"

namespace hapbench {
namespace {

/// Pairs of a field and the field that it excludes. Each pair is listed in both orders.
constexpr std::pair<std::string_view, const char*> kExclusiveFields[] = {
    {"steps", "duration_s"}, {"duration_s", "steps"},      {"path_m", "direction"},
    {"direction", "path_m"}, {"delay_s", "delay_samples"}, {"delay_samples", "delay_s"}};

}  // namespace

void drop_alternative(Json& object, std::string_view field) {
  for (const auto& [given, other] : kExclusiveFields)
    if (given == field) object.erase(other);
}

void merge_fields(Json& base, const Json& more) {
  const bool other_type =
      more.contains(kTypeField) && (!base.contains(kTypeField) || base[kTypeField] != more[kTypeField]);
  if (!base.is_object() || !more.is_object() || other_type) {
    base = more;
    return;
  }
  for (const auto& entry : more.items()) drop_alternative(base, entry.key());
  for (const auto& entry : more.items()) merge_fields(base[entry.key()], entry.value());
}

void drop_derived_samples(Json& scenario) {
  if (scenario.contains(Json::json_pointer("/device/delay_s"))) scenario["device"].erase("delay_samples");
}

}  // namespace hapbench
