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

bool concerns(const ChosenField& field, const std::string& scenario) {
  return std::ranges::any_of(field.scenarios, [&](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), scenario.c_str(), 0) == 0;
  });
}

using Place = std::pair<std::string, Json*>;  ///< a dotted path, and the value there

/// The places below a place that a key of a dotted path stands for: the entry of this name, or all entries of a list
/// for
/// "*". Throws InputError when there is none.
std::vector<Place> places_below(const Place& place, std::string_view key) {
  const auto& [at, node] = place;
  const bool every = key == "*" && node->is_array();
  std::vector<Place> below;
  for (auto& [name, value] : node->items())
    if (every || name == key) below.emplace_back(at.empty() ? name : at + "." + name, &value);
  if (below.empty() && !every)
    throw InputError(fmt::format("{} has no {} \"{}\"", at.empty() ? "the scenario" : '"' + at + '"',
                                 node->is_array() ? "entry" : "field", key));
  return below;
}

/// The places that a dotted path stands for. Throws InputError.
std::vector<Place> places_of(Json& scenario, const std::string& path) {
  std::vector<Place> places = {{"", &scenario}};
  for (const std::string_view key : parts_of(path, '.')) {
    std::vector<Place> below;
    for (const Place& place : places) {
      const std::vector<Place> found = places_below(place, key);
      below.insert(below.end(), found.begin(), found.end());
    }
    places = std::move(below);
  }
  return places;
}

/// The text of a choice's value at a place. Throws InputError.
std::string chosen_text(const Place& place, const ChosenField& field, const std::string& value) {
  if (!field.times) return value;
  if (!place.second->is_number())
    throw InputError(fmt::format("\"{}\" is no number, which a factor needs", place.first));
  return cell_text(finite_number(value).value_or(1.0) * place.second->get<double>());
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
  Json changed = effective_scenario(scenario, scenario.directory);  // with every default, so that every field exists
  Json texts = Json::object();                                      // by path, in the order of their first change
  for (std::size_t i = 0; i < all_.size(); ++i) {
    for (const ChosenField& field : all_[i].fields) {
      if (!concerns(field, scenario.name)) continue;
      try {
        for (const Place& place : places_of(changed, field.path)) {
          const std::string text = chosen_text(place, field, values[i]);
          *place.second = Json::accept(text) ? parse_json(text) : Json(text);
          texts[place.first] = text;
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
