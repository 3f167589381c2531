#include "scenarios/scene/field_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "results/io/columns.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/overrides.hpp"
#include "scenarios/scene/scenario_schema.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Beginning of the error message about a field that does not exist.
constexpr std::string_view kUnknownField = "unknown field";

/// Returns a hint for an unknown field whose name resembles no field of its object. Searches all objects of a scenario
/// for the field name that is most similar to the unknown name. The hint lists the paths of all fields with this name,
/// or says that only an object of another type has the field. Empty if no name is similar.
std::string hint_from_other_objects(const std::string& pointer) {
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
  return is_of_law ? "; the parameters of a law in a module need the option --module"
                   : hint_from_other_objects(fault.location().pointer);
}

/// Returns a copy of the fault. Adds `file` to its location, and a hint to the message about an unknown name.
InputError in_file(const InputError& fault, const fs::path& file) {
  ErrorLocation location = fault.location();
  if (!location.file.empty()) {  // true if the fault is in a file that the scenario names
    location.outer.insert(location.outer.begin(), file);
    return {fault.kind(), location, fault.problem()};
  }
  location.file = file;
  std::string problem = fault.problem();
  if (problem.find("nearest valid name") == std::string::npos) {
    if (problem.starts_with(kUnknownField)) problem.insert(kUnknownField.size(), hint_for(fault));
    if (location.pointer == "/rendering/algorithm") problem += "; a law in a module needs the option --module";
  }
  return {fault.kind(), location, problem};
}

}  // namespace

void rethrow_with_file(const InputError& error, const fs::path& file) {
  LoadedScenario source;
  source.file = file;
  rethrow_with_file(error, source);
}

void rethrow_with_file(const InputError& error, const LoadedScenario& loaded) {
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    const ErrorLocation& location = fault.location();
    const fs::path& outermost = location.outer.empty() ? location.file : location.outer.front();
    if (!outermost.empty() && outermost == loaded.file) {
      faults.push_back(fault);
      continue;
    }
    faults.push_back(in_file(fault, location.file.empty() ? file_of(loaded, location.pointer) : loaded.file));
  }
  throw InputError::all(faults);
}

fs::path file_of(const LoadedScenario& loaded, const std::string& pointer) {
  if (!pointer.starts_with('/')) return loaded.file;
  // Search for a file that sets the field. If no file sets the field, search for a file that has the enclosing object.
  for (Json::json_pointer at(pointer); !at.empty(); at = at.parent_pointer()) {
    for (const ScenarioLayer& layer : loaded.layers)
      if (layer.json.contains(at)) return layer.file;
  }
  return loaded.file;
}

std::vector<std::string> with_files(const LoadedScenario& loaded, const std::vector<Warning>& warnings) {
  std::vector<std::string> texts;
  for (const Warning& warning : warnings) {
    const auto override = std::ranges::find(loaded.overrides, warning.pointer, overridden_pointer);
    // The text does not have the value of the override, so that a sweep of the field warns once.
    texts.push_back(override == loaded.overrides.end()
                        ? file_of(loaded, warning.pointer).string() + ": " + warning.located_text()
                        : fmt::format("{}, overridden field {}: {}", loaded.scenario.name, overridden_path(*override),
                                      warning.text));
  }
  return texts;
}

}  // namespace hapbench
