#include "scenarios/thesis/assumptions.hpp"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <iterator>
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
#include "scenarios/scene/overrides.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/hash.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Returns the assumption of a JSON entry. Throws Json::exception if a key is missing or has a wrong type.
Assumption assumption_of(const Json& json) {
  const Json& value = json.at("value");
  Json without_prose = json;
  for (const char* prose : {"what", "thesis", "chosen", "why"}) without_prose.erase(prose);
  Assumption assumption{.id = json.at("id").get<std::string>(),
                        .value = value.is_number() ? cell_text(value.get<double>()) : value.get<std::string>(),
                        .options = json.value("options", std::vector<std::string>()),
                        .text = json_text(without_prose)};
  assumption.logarithmic = json.value("scale", "linear") == "log";
  if (json.contains("calibrated")) {
    const Json& to = json.at("calibrated");
    assumption.calibration = {to.at("scenario").get<std::string>(), to.at("raw").get<double>()};
  }
  if (json.contains("range")) assumption.range = json.at("range").get<std::pair<double, double>>();
  for (const Json& field : json.value("fields", Json::array()))
    assumption.fields.push_back({field.at("scenarios").get<std::vector<std::string>>(),
                                 field.at("path").get<std::string>(), field.value("times", false)});
  return assumption;
}

/// Returns true if a pattern of the field matches the scenario's name.
bool concerns(const AssumedField& field, const std::string& scenario) {
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

/// Returns the new value of a location, as text. If `field.times` is false, returns `value`. If it is true, returns
/// `value` times the number at the location, and throws InputError if the location has no number.
std::string assumed_text(const Location& location, const AssumedField& field, const std::string& value) {
  if (!field.times) return value;
  if (!location.second->is_number())
    throw InputError(fmt::format("\"{}\" is no number, which a factor needs", location.first));
  return cell_text(finite_number(value).value_or(1.0) * location.second->get<double>());
}

}  // namespace

std::vector<std::string> Assumption::other_values(bool middle_too) const {
  std::vector<std::string> values;
  if (!range) {
    std::ranges::copy_if(options, std::back_inserter(values), [this](const auto& option) { return option != value; });
    return values;
  }
  // Compare the values on the scale of the range: logarithmic or linear.
  const auto [low, high] = *range;
  const auto scaled = [this](double number) { return logarithmic ? math::log(number) : number; };
  const double recorded = finite_number(value).value(),
               middle = logarithmic ? std::sqrt(low * high) : 0.5 * (low + high);
  const double near = 0.1 * (scaled(high) - scaled(low));
  if (low != recorded) values.push_back(cell_text(low));
  if (middle_too && std::abs(scaled(middle) - scaled(recorded)) > near) values.push_back(fmt::format("{:.3g}", middle));
  if (high != recorded) values.push_back(cell_text(high));
  return values;
}

bool Assumption::reaches(std::span<const std::string> scenarios, const std::string& rule) const {
  if (fields.empty()) {
    const std::string name = "<" + id;
    return rule.find(name + ">") != std::string::npos || rule.find(name + ".mean") != std::string::npos;
  }
  return std::ranges::any_of(fields, [&](const AssumedField& field) {
    return std::ranges::any_of(scenarios, [&](const auto& scenario) { return concerns(field, scenario); });
  });
}

Assumptions::Assumptions(const fs::path& file) {
  std::string at = "/assumptions";
  try {
    const Json json = with_file(file, [&] { return read_json(file); });
    hash_ = hash_text(hash_of(json_text(json)));
    for (const Json& assumption : json.at("assumptions")) {
      at = element("/assumptions", all_.size());
      all_.push_back(assumption_of(assumption));
    }
  } catch (const Json::exception& problem) {
    fail_in_file(file, fmt::format("{}: {}; allowed: what assumptions.schema.json says", at, problem.what()));
  }
}

std::vector<std::string> Assumptions::recorded_values() const {
  return names_of(all_, &Assumption::value);
}

std::vector<std::string> Assumptions::overrides(const Scenario& scenario, std::span<const std::string> values) const {
  // Apply the assumptions one after the other to the scenario's JSON, and remember the text of each changed field.
  // `changed` begins as the scenario with all defaults, so that every field exists.
  Json changed = effective_scenario(scenario, scenario.directory);
  Json texts = Json::object();  // new values, by path
  for (std::size_t i = 0; i < all_.size(); ++i) {
    for (const AssumedField& field : all_[i].fields) {
      if (!concerns(field, scenario.name)) continue;
      try {
        for (const Location& location : locations_of(changed, field.path)) {
          const std::string text = assumed_text(location, field, values[i]);
          *location.second = override_value(text);
          texts[location.first] = text;
        }
      } catch (const InputError& error) {
        throw InputError(fmt::format("assumption \"{}\": in scenario {}, {}", all_[i].id, scenario.name, error.what()));
      }
    }
  }
  std::vector<std::string> overrides;
  for (const auto& [path, text] : texts.items()) overrides.push_back(path + "=" + text.get<std::string>());
  return overrides;
}

PublishedNumbers Assumptions::with_numbers(PublishedNumbers published, std::span<const std::string> values) const {
  for (std::size_t i = 0; i < all_.size(); ++i)
    if (all_[i].fields.empty()) published.set(all_[i].id, finite_number(values[i]).value());
  return published;
}

std::string Assumptions::reach(std::span<const std::string> scenarios, const std::string& rule) const {
  std::string reaching;
  for (const Assumption& assumption : all_)
    if (assumption.reaches(scenarios, rule)) reaching += assumption.text;
  return reaching.empty() ? "" : hash_text(hash_of(reaching));
}

Json assumptions_schema() {
  return read_json(installed_folder("results/reference") / "assumptions.schema.json");
}

}  // namespace hapbench
