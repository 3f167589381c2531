#include "scenarios/scene/load_scenario.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "scenarios/input/reader.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/describe_scenario.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/overrides.hpp"
#include "scenarios/scene/relation_warnings.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {

namespace fs = std::filesystem;

LoadedScenario read_scenario(const Json& json, const fs::path& directory) {
  LoadedScenario loaded;
  loaded.scenario.directory = directory;
  read_value(json, "", [&](Fields& f) { f.object(loaded.scenario); });
  loaded.warnings = relation_warnings(loaded.scenario, json);
  loaded.files = NamedFiles(loaded.scenario);
  return loaded;
}

LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides) {
  LoadedScenario loaded;
  loaded.file = text.file;
  loaded.layers = text.layers;
  return with_file(loaded, [&] {
    // Relax the expectations if an override changes the run.
    Json json = text.json;
    const bool same_run = std::all_of(overrides.begin(), overrides.end(), keeps_run_unchanged);
    if (!same_run && json.is_object() && json.contains("expect")) relax_expectations(json["expect"]);
    // Apply the overrides to the merged scenario and to the first layer. file_of uses the layers to find the file
    // that sets a value.
    for (const std::string& override : overrides) apply_override(json, override);
    if (!loaded.layers.empty()) {
      for (const std::string& override : overrides) apply_override(loaded.layers.front().json, override);
    }
    require_absolute_paths(text.file, json);
    // Read and check the fields.
    LoadedScenario read = read_scenario(json, text.file.parent_path());
    read.file = loaded.file;
    read.layers = std::move(loaded.layers);
    read.overrides = {overrides.begin(), overrides.end()};
    if (read.scenario.name.empty()) read.scenario.name = text.file.stem().string();
    return read;
  });
}

Json effective_scenario(const Scenario& scenario, const fs::path& directory) {
  Json json = written_object(scenario);
  // Make the paths of files relative to `directory`.
  const NamedFiles files(scenario);
  for (const auto& file : files.all()) {
    const fs::path path = fs::current_path() / file->path();
    std::error_code error;
    const fs::path near = fs::proximate(path, fs::current_path() / directory, error);
    json.at(Json::json_pointer(file->pointer())) = (error ? path : near).generic_string();
  }
  return json;
}

std::string scenario_hash(Json effective, const NamedFiles& files) {
  for (const auto& file : files.all()) effective.at(Json::json_pointer(file->pointer())) = file->hash();
  return hash_text(hash_of(json_text(effective)));
}

}  // namespace hapbench
