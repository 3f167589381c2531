#include "scenarios/thesis/choices.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>

#include "results/io/columns.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

OpenChoice choice_of(const Json& json) {
  const Json& value = json.at("value");
  OpenChoice choice{.id = json.at("id"),
                    .value = value.is_number() ? cell_text(value.get<double>()) : value.get<std::string>(),
                    .options = json.value("options", std::vector<std::string>())};
  if (json.contains("range")) choice.range = json.at("range").get<std::pair<double, double>>();
  for (const Json& field : json.value("fields", Json::array()))
    choice.fields.push_back({field.at("scenarios"), field.at("path"), field.value("times", false)});
  return choice;
}

bool concerns(const ChosenField& field, const std::string& scenario) {
  return std::ranges::any_of(field.scenarios, [&](const auto& pattern) { return names_scenario(pattern, scenario); });
}

using Place = std::pair<std::string, Json*>;  ///< a dotted path, and the value there

/// The places that a dotted path stands for. Throws InputError.
std::vector<Place> places_of(Json& scenario, const std::string& path) {
  std::vector<Place> places = {{"", &scenario}};
  for (const std::string_view key : parts_of(path, '.')) {
    std::vector<Place> below;
    for (const auto& [at, node] : places) {
      const bool every = key == "*" && node->is_array();
      bool found = every;
      for (auto& [name, value] : node->items()) {
        if (!every && name != key) continue;
        below.emplace_back(at.empty() ? name : at + "." + name, &value);
        found = true;
      }
      if (!found)
        throw InputError(fmt::format("{} has no {} \"{}\"", at.empty() ? "the scenario" : '"' + at + '"',
                                     node->is_array() ? "entry" : "field", key));
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

bool names_scenario(const std::string& pattern, const std::string& scenario) {
  return ::fnmatch(pattern.c_str(), scenario.c_str(), 0) == 0;
}

Choices::Choices(const std::filesystem::path& file) {
  std::string at = "/choices";
  try {
    const Json json = read_json(file);
    hash_ = hash_text(hash_of(json_text(json)));
    for (const Json& choice : json.at("choices")) {
      at = element("/choices", all_.size());
      all_.push_back(choice_of(choice));
      texts_.push_back(json_text(choice));
    }
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
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
  for (std::size_t i = 0; i < all_.size(); ++i) {
    if (all_[i].fields.empty()) published.set(all_[i].id, finite_number(values[i]).value());
  }
  return published;
}

std::string Choices::reach(std::span<const std::string> scenarios, const std::string& rule) const {
  std::string reaching;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const std::string name = "<" + all_[i].id;
    const bool sets = std::ranges::any_of(all_[i].fields, [&](const ChosenField& field) {
      return std::ranges::any_of(scenarios, [&](const auto& scenario) { return concerns(field, scenario); });
    });
    const bool named = rule.find(name + ">") != std::string::npos || rule.find(name + ".mean") != std::string::npos;
    if (sets || (all_[i].fields.empty() && named)) reaching += texts_[i];
  }
  return reaching.empty() ? "" : hash_text(hash_of(reaching));
}

Json choices_schema() {
  return read_json(installed_folder("results/reference") / "choices.schema.json");
}

}  // namespace hapbench
