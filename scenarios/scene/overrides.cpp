#include "scenarios/scene/overrides.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/merge_scenarios.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

/// Returns the element list[key]. Throws InputError if `key` is not an index of the list. `path`: the dotted path that
/// contains the key.
Json& element_at(Json& list, std::string_view key, const std::string& path) {
  const auto index = whole_number(key);
  if (!index || *index >= list.size()) {
    throw InputError(fmt::format("{}: got list index \"{}\"; allowed: {}", path, key,
                                 list.empty() ? "none, the list is empty" : fmt::format("0 ... {}", list.size() - 1)));
  }
  return list[*index];
}

}  // namespace

Json override_value(const std::string& text) {
  if (Json::accept(text) || text.starts_with('{') || text.starts_with('[')) return parse_json(text);
  std::string_view number_text = text;
  if (text.starts_with('+') && !text.starts_with("+-")) number_text.remove_prefix(1);
  if (const auto number = finite_number(number_text)) return *number;
  return text;
}

void apply_override(Json& json, const std::string& text) {
  // Split and check the override.
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    fail_in_option("--set", "got \"" + text + "\"; allowed: path=value, such as rendering.stiffness_N_per_m=40000");
  const std::string path = text.substr(0, equals), value = text.substr(equals + 1);
  const Words keys = parts_of(path, '.');
  constexpr std::size_t kMaxPathDepth = 64;  // functions that process JSON recurse once for each level
  if (keys.size() > kMaxPathDepth)
    fail_in_option("--set", fmt::format("got a path of more than {0} keys; allowed: at most {0}", kMaxPathDepth));
  if (std::ranges::any_of(keys, &std::string_view::empty))
    fail_in_option("--set", fmt::format("got the path \"{}\"; allowed: names with one dot between them, such as "
                                        "rendering.stiffness_N_per_m",
                                        path));
  // Follow the path, creating objects where they are missing.
  Json* node = &json;
  for (const std::string_view& key : keys) {
    if (node->is_array()) {
      node = &element_at(*node, key, path);
    } else {
      if (!node->is_object()) *node = Json::object();  // replaces null or a number
      if (&key == &keys.back()) drop_alternative(*node, key);
      node = &(*node)[std::string(key)];
    }
  }
  *node = override_value(value);
  if (path == "time" || path == "time.step_s") drop_derived_samples(json);
}

std::string overridden_pointer(std::string_view override) {
  std::string pointer = "/" + std::string(overridden_path(override));
  std::ranges::replace(pointer, '.', '/');
  return pointer;
}

bool keeps_run_unchanged(std::string_view override) {
  constexpr std::string_view kWithoutEffect[] = {"expect", "record", "name", "description", "source"};
  // Fields of `record` that change the metrics: the first three add or remove metrics, and `record.every` selects the
  // steps that the ideal-trajectory metrics use.
  constexpr std::string_view kMeasured[] = {"record.energy", "record.ideal_trajectory", "record.torque",
                                            "record.every"};
  const std::string_view path = overridden_path(override), section = path.substr(0, path.find('.'));
  return std::ranges::count(kWithoutEffect, section) > 0 && std::ranges::count(kMeasured, path) == 0;
}

void relax_expectations(Json& expect) {
  if (!expect.is_object()) return;  // the reader reports this error
  expect.erase("metrics");
  Json outcomes = Json::array();
  for (const Outcome outcome : ExpectFields().outcomes) outcomes.push_back(outcome_name(outcome));
  const Json given = expect.value("outcome", Json());
  for (const Json& outcome : given.is_array() ? given : given.is_null() ? Json::array() : Json::array({given})) {
    if (std::find(outcomes.begin(), outcomes.end(), outcome) == outcomes.end()) outcomes.push_back(outcome);
  }
  expect["outcome"] = std::move(outcomes);
}

}  // namespace hapbench
