#include "scenarios/scene/scenario_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/pipe_contents.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/merge_scenarios.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Prepends `directory` to each relative path in a field "file".
void rebase_relative_paths(Json& json, const fs::path& directory) {
  if (!json.is_structured()) return;
  for (auto& entry : json.items()) {
    Json& value = entry.value();
    if (entry.key() == kFileField && value.is_string()) {
      value = (directory / value.get<std::string>()).string();
    } else {
      rebase_relative_paths(value, directory);
    }
  }
}

/// Throws InputError at the first relative path in a field "file" of the value at `pointer`.
void refuse_relative_paths(const Json& json, const std::string& pointer) {
  if (!json.is_structured()) return;
  for (const auto& entry : json.items()) {
    const std::string at = member(pointer, entry.key());
    const bool names_file = entry.key() == kFileField && entry.value().is_string();
    if (!names_file) refuse_relative_paths(entry.value(), at);
    if (names_file && fs::path(entry.value().get<std::string>()).is_relative()) {
      fail_at(at, fmt::format(
                      "got {}, a path from the folder of the scenario, which a scenario from a pipe does not have; "
                      "allowed: an absolute path, such as {}",
                      shown(entry.value()), shown((fs::current_path() / entry.value().get<std::string>()).string())));
    }
  }
}

/// Throws InputError if `next` is already one of the layers, because the files then extend each other in a circle.
void check_chain(const std::vector<ScenarioLayer>& layers, const fs::path& next) {
  std::error_code ignored;
  const auto is_next = [&](const ScenarioLayer& layer) { return fs::equivalent(layer.file, next, ignored); };
  if (std::ranges::none_of(layers, is_next)) return;
  std::string chain;
  for (const ScenarioLayer& layer : layers) chain += layer.file.string() + " -> ";
  throw InputError(
      fmt::format("got a cycle of base scenarios, {}{}; allowed: a chain of base scenarios without repetition", chain,
                  next.string()));
}

/// Returns the file that `json` extends. `json` was read from `file`.
fs::path base_file(const Json& json, const fs::path& file, const std::vector<ScenarioLayer>& layers) {
  const Json& name = json[kExtends];
  const std::string at = fmt::format("/{}", kExtends);
  if (!name.is_string()) {
    throw InputError(InputError::Kind::shape, at,
                     fmt::format("got {}; allowed: a scenario file or the name of a bundled scenario", shown(name)));
  }
  try {
    fs::path base = find_scenario(name.get<std::string>(), file.parent_path());
    check_chain(layers, base);
    return base;
  } catch (const InputError& error) {
    fail_at(at, error.problem() + (has_no_folder(file) ? "; a scenario from a pipe needs an absolute path" : ""));
  }
}

/// Appends to `layers` the file and, recursively, all files that it extends. Returns the merged fields of these files.
Json read_extended(const fs::path& file, std::vector<ScenarioLayer>& layers) {
  // Read this file.
  Json json;
  fs::path base;
  with_file(file, [&] {
    json = read_json(file);
    layers.push_back({file, json});
    if (json.contains(kExtends)) base = base_file(json, file, layers);
    if (layers.size() > 1 && !json.is_object())
      throw InputError(fmt::format("got {}; allowed: a scenario, which is an object", shown(json)));
  });
  if (base.empty()) return json;
  // Read the base, and drop the fields that are not inherited.
  Json merged = read_extended(base, layers);
  if (base.parent_path() != file.parent_path()) rebase_relative_paths(merged, fs::current_path() / base.parent_path());
  for (const char* own : {"name", "expect"}) merged.erase(own);
  // Merge this file over the base.
  json.erase(kExtends);
  if (json.contains(Json::json_pointer("/time/step_s"))) drop_derived_samples(merged);
  merge_fields(merged, json);
  return merged;
}

}  // namespace

void require_absolute_paths(const fs::path& file, const Json& json) {
  if (has_no_folder(file)) refuse_relative_paths(json, "");
}

ScenarioText read_scenario_text(const fs::path& file) {
  std::vector<ScenarioLayer> layers;
  Json json = read_extended(file, layers);
  if (layers.size() == 1) layers.clear();
  return {file, std::move(json), std::move(layers)};
}

}  // namespace hapbench
