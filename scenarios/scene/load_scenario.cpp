#include "scenarios/scene/load_scenario.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "results/io/columns.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/reader.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/describe_scenario.hpp"
#include "scenarios/scene/relation_warnings.hpp"
#include "scenarios/scene/scenario_schema.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Pairs of a field and the field that it excludes. Each pair is listed in both orders.
constexpr std::pair<std::string_view, const char*> kEitherOr[] = {
    {"steps", "duration_s"}, {"duration_s", "steps"},      {"path_m", "direction"},
    {"direction", "path_m"}, {"delay_s", "delay_samples"}, {"delay_samples", "delay_s"}};

/// Removes from `object` the field that excludes `field`.
void drop_alternative(Json& object, std::string_view field) {
  for (const auto& [given, other] : kEitherOr)
    if (given == field) object.erase(other);
}

/// Merges `more` over `base` by the rules of read_scenario_text.
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

/// Removes `delay_samples` of the device if `delay_s` is there too. An effective scenario has both, but the
/// number of samples was computed for a time step that has changed since.
void drop_derived_samples(Json& scenario) {
  if (scenario.contains(Json::json_pointer("/device/delay_s"))) scenario["device"].erase("delay_samples");
}

/// Prepends `directory` to each relative path in a field "file".
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

/// Throws InputError if `next` is already one of the layers, so that files extend each other in a circle.
void check_chain(const std::vector<ScenarioLayer>& layers, const fs::path& next) {
  std::error_code ignored;
  const auto is_next = [&](const ScenarioLayer& layer) { return fs::equivalent(layer.file, next, ignored); };
  if (std::ranges::none_of(layers, is_next)) return;
  std::string chain;
  for (const ScenarioLayer& layer : layers) chain += layer.file.string() + " -> ";
  throw InputError(fmt::format("got a circle, {}{}; allowed: a chain that ends", chain, next.string()));
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
    fail_at(at, error.problem());
  }
}

/// Appends the file and, recursively, the files that it extends to `layers`. Returns their merged fields.
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
  // Read the base, and drop what is not inherited.
  Json merged = read_extended(base, layers);
  if (base.parent_path() != file.parent_path()) keep_files(merged, fs::current_path() / base.parent_path());
  for (const char* own : {"name", "expect"}) merged.erase(own);
  // Merge this file over the base.
  json.erase(kExtends);
  if (json.contains(Json::json_pointer("/time/step_s"))) drop_derived_samples(merged);
  merge(merged, json);
  return merged;
}

/// Applies an override "path=value". A number in the dotted path is an index of a list. A field that excludes the
/// overridden field is removed.
void apply_override(Json& json, const std::string& text) {
  // Split and check the override.
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos)
    fail_in_option("--set", "got \"" + text + "\"; allowed: path=value, as in rendering.stiffness_N_per_m=40000");
  const std::string path = text.substr(0, equals), value = text.substr(equals + 1);
  const Words keys = parts_of(path, '.');
  constexpr std::size_t kDeepestPath = 64;  // functions that walk through JSON recurse once per level
  if (keys.size() > kDeepestPath)
    fail_in_option("--set", fmt::format("got a path of more than {0} keys; allowed: at most {0}", kDeepestPath));
  // Follow the path, creating objects where they are missing.
  Json* node = &json;
  for (const std::string_view& key : keys) {
    if (node->is_array()) {
      const auto index = whole_number(key);
      if (!index || *index >= node->size()) {
        throw InputError(
            fmt::format("{}: got list index \"{}\"; allowed: {}", path, key,
                        node->empty() ? "none, the list is empty" : fmt::format("0 ... {}", node->size() - 1)));
      }
      node = &(*node)[*index];
    } else {
      if (!node->is_object()) *node = Json::object();  // replaces null or a number
      if (&key == &keys.back()) drop_alternative(*node, key);
      node = &(*node)[std::string(key)];
    }
  }
  *node = Json::accept(value) ? parse_json(value) : Json(value);
  if (path == "time" || path == "time.step_s") drop_derived_samples(json);
}

/// Returns true if the override does not change the run, so that the scenario's expectations still apply to it.
bool leaves_run_alone(std::string_view override) {
  constexpr std::string_view kSections[] = {"expect", "record", "name", "description", "source"};
  // These fields add or remove metrics. `record.every` also selects the steps that the ideal-trajectory metrics
  // use.
  constexpr std::string_view kMeasured[] = {"record.energy", "record.ideal_trajectory", "record.torque",
                                            "record.every"};
  const std::string_view path = overridden_path(override), section = path.substr(0, path.find('.'));
  return std::ranges::count(kSections, section) > 0 && std::ranges::count(kMeasured, path) == 0;
}

/// Relaxes the expectations for a run that an override has changed. Removes the bounds on metrics, and adds the
/// default outcomes to the listed outcomes. A run that never touches its object or diverges stays unexpected
/// unless the scenario lists that outcome.
void expect_less(Json& expect) {
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

/// Beginning of the reader's message about a field that does not exist.
constexpr std::string_view kUnknownField = "unknown field";

/// Returns a hint for an unknown field whose name resembles no field of its object: the paths of the fields with
/// the nearest name in other objects. Empty if there are none.
std::string hint_elsewhere(const std::string& pointer) {
  const std::vector<std::string> paths = scenario_field_paths();
  const auto own_name = [](const std::string& path) { return parts_of(path, '.').back(); };
  const std::string nearest = nearest_name(parts_of(pointer, '/').back(), names_of(paths, own_name));
  std::vector<std::string> found;
  std::ranges::copy_if(paths, std::back_inserter(found), [&](const auto& path) { return own_name(path) == nearest; });
  std::string typed = pointer.substr(1);
  std::replace(typed.begin(), typed.end(), '/', '.');
  if (std::find(found.begin(), found.end(), typed) != found.end()) return "; only an object of another type has it";
  return found.empty() ? "" : "; nearest valid names: " + quoted_list(found);
}

/// Returns the hint for an unknown field whose name resembles no field of its object. May be empty.
std::string hint_for(const InputError& fault) {
  const bool is_of_law = fault.location().pointer.starts_with("/rendering/parameters/");
  return is_of_law ? "; a law from outside brings its own with --module" : hint_elsewhere(fault.location().pointer);
}

/// Returns the fault with the file's name in its location, and with hints for unknown names.
InputError in_file(const InputError& fault, const fs::path& file) {
  ErrorLocation location = fault.location();
  if (!location.file.empty()) {  // the fault is in a file that the scenario names
    location.outer.insert(location.outer.begin(), file);
    return {fault.kind(), location, fault.problem()};
  }
  location.file = file;
  std::string problem = fault.problem();
  if (problem.find("nearest valid name") == std::string::npos) {
    if (problem.starts_with(kUnknownField)) problem.insert(kUnknownField.size(), hint_for(fault));
    if (location.pointer == "/rendering/algorithm") problem += "; a law from outside comes with --module";
  }
  return {fault.kind(), location, problem};
}

}  // namespace

void rethrow_with_file(const InputError& error, const fs::path& file) {
  LoadedScenario place;
  place.file = file;
  rethrow_with_file(error, place);
}

void rethrow_with_file(const InputError& error, const LoadedScenario& loaded) {
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    const ErrorLocation& location = fault.location();
    faults.push_back(in_file(fault, location.file.empty() ? file_of(loaded, location.pointer) : loaded.file));
  }
  throw InputError::all(faults);
}

LoadedScenario read_scenario(const Json& json, const fs::path& directory) {
  LoadedScenario loaded;
  loaded.scenario.directory = directory;
  read_value(json, "", [&](Fields& f) { f.object(loaded.scenario); });
  loaded.warnings = relation_warnings(loaded.scenario, json);
  loaded.files = NamedFiles(loaded.scenario);
  return loaded;
}

ScenarioText read_scenario_text(const fs::path& file) {
  std::vector<ScenarioLayer> layers;
  Json json = read_extended(file, layers);
  if (layers.size() == 1) layers.clear();
  return {file, std::move(json), std::move(layers)};
}

fs::path file_of(const LoadedScenario& loaded, const std::string& pointer) {
  if (!pointer.starts_with('/')) return loaded.file;
  // A field that no file sets has its default value. Then search for the object around it.
  for (Json::json_pointer at(pointer); !at.empty(); at = at.parent_pointer()) {
    for (const ScenarioLayer& layer : loaded.layers)
      if (layer.json.contains(at)) return layer.file;
  }
  return loaded.file;
}

std::vector<std::string> with_files(const LoadedScenario& loaded, const std::vector<Warning>& warnings) {
  std::vector<std::string> texts;
  for (const Warning& warning : warnings)
    texts.push_back(file_of(loaded, warning.pointer).string() + ": " + warning.told());
  return texts;
}

LoadedScenario load_scenario(const ScenarioText& text, std::span<const std::string> overrides) {
  LoadedScenario loaded;
  loaded.file = text.file;
  loaded.layers = text.layers;
  return with_file(loaded, [&] {
    // Relax the expectations if an override changes the run.
    Json json = text.json;
    const bool same_run = std::all_of(overrides.begin(), overrides.end(), leaves_run_alone);
    if (!same_run && json.is_object() && json.contains("expect")) expect_less(json["expect"]);
    // Apply the overrides, also to the first layer, from which file_of finds the file of a value.
    for (const std::string& override : overrides) apply_override(json, override);
    if (!loaded.layers.empty()) {
      for (const std::string& override : overrides) apply_override(loaded.layers.front().json, override);
    }
    // Read and check the fields.
    LoadedScenario read = read_scenario(json, text.file.parent_path());
    read.file = loaded.file;
    read.layers = std::move(loaded.layers);
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
