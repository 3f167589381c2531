#include "scenarios/description/extends.hpp"

#include <fmt/format.h>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/schema_writer.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Fields of which an object has one or the other.
constexpr std::pair<std::string_view, const char*> kEitherOr[] = {
    {"steps", "duration_s"}, {"duration_s", "steps"}, {"path_m", "direction"}, {"direction", "path_m"}};

void merge(Json& base, const Json& more) {
  const bool other_type =
      more.contains(kTypeField) && (!base.contains(kTypeField) || base[kTypeField] != more[kTypeField]);
  if (!base.is_object() || !more.is_object() || other_type) {
    base = more;
    return;
  }
  for (const auto& entry : more.items()) drop_alternative(base, entry.key());
  for (const auto& entry : more.items()) merge(base[entry.key()], entry.value());
}

/// Lets the files named by relative paths start from `directory`.
void keep_files(Json& json, const fs::path& directory) {
  if (!json.is_structured()) return;
  for (auto& entry : json.items()) {
    Json& value = entry.value();
    if (entry.key() == kFileField && value.is_string()) {
      value = (directory / value.get<std::string>()).string();
    } else {
      keep_files(value, directory);
    }
  }
}

/// Refuses a chain in which the next file stands already.
void check_chain(const std::vector<ScenarioLayer>& layers, const fs::path& next) {
  std::error_code ignored;
  std::string chain;
  bool again = false;
  for (const ScenarioLayer& layer : layers) {
    chain += layer.file.string() + " -> ";
    again = again || fs::equivalent(layer.file, next, ignored);
  }
  if (!again) return;
  throw InputError(InputError::Kind::relation, fmt::format("/{}", kExtends),
                   fmt::format("got a circle, {}{}; allowed: a chain that ends", chain, next.string()));
}

/// The file that `json`, read from `file`, extends.
fs::path base_file(const Json& json, const fs::path& file, const std::vector<ScenarioLayer>& layers) {
  const Json& name = json[kExtends];
  const std::string at = fmt::format("/{}", kExtends);
  if (!name.is_string()) {
    throw InputError(InputError::Kind::shape, at,
                     fmt::format("got {}; allowed: a scenario file or the name of a bundled scenario", shown(name)));
  }
  fs::path base;
  try {
    base = find_scenario(name.get<std::string>(), file.parent_path());
  } catch (const InputError& error) {
    throw InputError(InputError::Kind::relation, at, error.problem());
  }
  check_chain(layers, base);
  return base;
}

}  // namespace

void drop_alternative(Json& object, std::string_view field) {
  for (const auto& [given, other] : kEitherOr) {
    if (given == field) object.erase(other);
  }
}

Json read_extended(const fs::path& file, std::vector<ScenarioLayer>& layers) {
  Json json;
  fs::path base;
  try {
    json = parse_json(read_text_file(file, kLargestJsonFile));
    layers.push_back({file, json});
    if (json.contains(kExtends)) base = base_file(json, file, layers);
    if (layers.size() > 1 && !json.is_object())
      throw InputError(fmt::format("got {}; allowed: a scenario, which is an object", shown(json)));
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
  if (base.empty()) return json;
  Json merged = read_extended(base, layers);
  if (base.parent_path() != file.parent_path()) keep_files(merged, fs::current_path() / base.parent_path());
  for (const char* own : {"name", "expect"}) merged.erase(own);
  json.erase(kExtends);
  merge(merged, json);
  return merged;
}

}  // namespace hapbench
