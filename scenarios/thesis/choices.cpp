#include "scenarios/thesis/choices.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <string_view>

#include "results/io/columns.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/json_schema.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns the choice of a JSON entry. Throws Json::exception if a key is missing or has a wrong type.
OpenChoice choice_of(const Json& json) {
  const Json& value = json.at("value");
  OpenChoice choice{.id = json.at("id").get<std::string>(),
                    .value = value.is_number() ? cell_text(value.get<double>()) : value.get<std::string>(),
                    .options = json.value("options", std::vector<std::string>()),
                    .text = json_text(json)};
  if (json.contains("range")) choice.range = json.at("range").get<std::pair<double, double>>();
  for (const Json& field : json.value("fields", Json::array()))
    choice.fields.push_back({field.at("scenarios").get<std::vector<std::string>>(), field.at("path").get<std::string>(),
                             field.value("times", false)});
  return choice;
}

/// Returns true if a pattern of the field matches the scenario's name.
bool concerns(const ChosenField& field, const std::string& scenario) {
  return std::ranges::any_of(field.scenarios, [&](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), scenario.c_str(), 0) == 0;
  });
}

using Location = std::pair<std::string, Json*>;  ///< a dotted path, and the value at this path

/// Returns the children of a JSON location that a key of a dotted path matches: the entry with this name, or all
/// entries of a list for "*". Throws InputError if a name has no entry.
std::vector<Location> children_of(const Location& location, std::string_view key) {
  const auto& [at, node] = location;
  const bool every = key == "*" && node->is_array();
  std::vector<Location> below;
  for (auto& [name, value] : node->items())
    if (every || name == key) below.emplace_back(at.empty() ? name : fmt::format("{}.{}", at, name), &value);
  if (below.empty() && !every)
    throw InputError(fmt::format("{} has no {} \"{}\"", at.empty() ? "the scenario" : '"' + at + '"',
                                 node->is_array() ? "entry" : "field", key));
  return below;
}

/// Returns all locations that a dotted path matches. Throws InputError if there are none.
std::vector<Location> locations_of(Json& scenario, const std::string& path) {
  std::vector<Location> locations = {{"", &scenario}};
  for (const std::string_view key : parts_of(path, '.')) {
    std::vector<Location> below;
    for (const Location& location : locations) {
      const std::vector<Location> found = children_of(location, key);
      below.insert(below.end(), found.begin(), found.end());
    }
    locations = std::move(below);
  }
  return locations;
}

/// Returns the new value of a location, as text: `value`, or `value` times the present number. Throws InputError.
std::string chosen_text(const Location& location, const ChosenField& field, const std::string& value) {
  if (!field.times) return value;
  if (!location.second->is_number())
    throw InputError(fmt::format("\"{}\" is no number, which a factor needs", location.first));
  return cell_text(finite_number(value).value_or(1.0) * location.second->get<double>());
}

}  // namespace

Choices::Choices(const fs::path& file) {
  std::string at = "/choices";
  try {
    const Json json = with_file(file, [&] { return read_json(file); });
    hash_ = hash_text(hash_of(json_text(json)));
    for (const Json& choice : json.at("choices")) {
      at = element("/choices", all_.size());
      all_.push_back(choice_of(choice));
    }
  } catch (const Json::exception& problem) {
    fail_in_file(file, fmt::format("{}: {}; allowed: what choices.schema.json says", at, problem.what()));
  }
}

std::vector<std::string> Choices::values_on_record() const {
  return names_of(all_, &OpenChoice::value);
}

std::vector<std::string> Choices::overrides(const Scenario& scenario, std::span<const std::string> values) const {
  // Apply the choices one after the other to the scenario's JSON, and remember the text of each changed field.
  Json changed = effective_scenario(scenario, scenario.directory);  // the scenario with all defaults, so that every
                                                                    // field exists
  Json texts = Json::object();                                      // new values, by path
  for (std::size_t i = 0; i < all_.size(); ++i) {
    for (const ChosenField& field : all_[i].fields) {
      if (!concerns(field, scenario.name)) continue;
      try {
        for (const Location& location : locations_of(changed, field.path)) {
          const std::string text = chosen_text(location, field, values[i]);
          *location.second = Json::accept(text) ? parse_json(text) : Json(text);
          texts[location.first] = text;
        }
      } catch (const InputError& error) {
        throw InputError(fmt::format("choice \"{}\": in scenario {}, {}", all_[i].id, scenario.name, error.what()));
      }
    }
  }
  std::vector<std::string> overrides;
  for (const auto& [path, text] : texts.items()) overrides.push_back(path + "=" + text.get<std::string>());
  return overrides;
}

PublishedNumbers Choices::with_numbers(PublishedNumbers published, std::span<const std::string> values) const {
  for (std::size_t i = 0; i < all_.size(); ++i)
    if (all_[i].fields.empty()) published.set(all_[i].id, finite_number(values[i]).value());
  return published;
}

std::string Choices::reach(std::span<const std::string> scenarios, const std::string& rule) const {
  std::string reaching;
  for (const OpenChoice& choice : all_) {
    const std::string name = "<" + choice.id;
    const bool sets = std::ranges::any_of(choice.fields, [&](const ChosenField& field) {
      return std::ranges::any_of(scenarios, [&](const auto& scenario) { return concerns(field, scenario); });
    });
    const bool named = rule.find(name + ">") != std::string::npos || rule.find(name + ".mean") != std::string::npos;
    if (sets || (choice.fields.empty() && named)) reaching += choice.text;
  }
  return reaching.empty() ? "" : hash_text(hash_of(reaching));
}

Json choices_schema() {
  return read_json(installed_folder("results/reference") / "choices.schema.json");
}

}  // namespace hapbench
