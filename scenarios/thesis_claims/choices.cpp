#include "scenarios/thesis_claims/choices.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fnmatch.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "results/io/json_text.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

std::string number_text(double number) {
  return std::string(std::string_view(NumberText(number)));
}

OpenChoice choice_of(const Json& json) {
  OpenChoice choice;
  for (const auto& [name, text] :
       {std::pair{"id", &choice.id}, std::pair{"what", &choice.what}, std::pair{"thesis", &choice.thesis},
        std::pair{"why", &choice.why}, std::pair{"chosen", &choice.chosen}})
    json.at(name).get_to(*text);
  const Json& value = json.at("value");
  choice.value = value.is_number() ? number_text(value.get<double>()) : value.get<std::string>();
  choice.unit = json.value("unit", "");
  if (json.contains("range")) choice.range = json.at("range").get<std::pair<double, double>>();
  choice.options = json.value("options", choice.options);
  choice.logarithmic = json.value("scale", "linear") == "log";
  for (const Json& field : json.value("fields", Json::array()))
    choice.fields.push_back({field.at("scenarios"), field.at("path"), field.value("times", false)});
  return choice;
}

bool concerns(const ChosenField& field, const std::string& scenario) {
  return std::any_of(field.scenarios.begin(), field.scenarios.end(),
                     [&scenario](const std::string& pattern) { return names_scenario(pattern, scenario); });
}

/// Changes fields of a scenario and records the changes.
class Changes {
 public:
  Changes(Json scenario, std::string name) : scenario_(std::move(scenario)), name_(std::move(name)) {}

  void apply(const OpenChoice& choice, const ChosenField& field, const std::string& value) {
    const Words keys = parts_of(field.path, '.');
    visit(
        scenario_, "", keys,
        [&](Json& node, const std::string& path) {
          std::string text = value;
          if (field.times) {
            if (!node.is_number()) fail(choice, path, "is no number, which a factor needs");
            text = number_text(finite_number(value).value_or(1.0) * node.get<double>());
          }
          node = Json::accept(text) ? parse_json(text) : Json(text);
          values_[path] = text;
        },
        choice);
  }

  std::vector<std::string> overrides() const {
    std::vector<std::string> texts;
    for (const auto& [path, value] : values_.items()) texts.push_back(path + "=" + value.get<std::string>());
    return texts;
  }

 private:
  template <class Work>
  void visit(Json& node, const std::string& path, std::span<const std::string_view> keys, const Work& work,
             const OpenChoice& choice) {
    if (keys.empty()) return work(node, path);
    const std::string key(keys.front());
    const auto below = [&](Json& child, const std::string& name) {
      visit(child, path.empty() ? name : path + "." + name, keys.subspan(1), work, choice);
    };
    if (node.is_array()) {
      const auto index = whole_number(key);
      if (key != "*" && (!index || *index >= node.size())) fail(choice, path, fmt::format("has no entry \"{}\"", key));
      for (std::size_t i = 0; i < node.size(); ++i) {
        if (key == "*" || i == *index) below(node[i], std::to_string(i));
      }
    } else {
      if (!node.is_object() || !node.contains(key)) fail(choice, path, fmt::format("has no field \"{}\"", key));
      below(node[key], key);
    }
  }

  [[noreturn]] void fail(const OpenChoice& choice, const std::string& path, const std::string& problem) const {
    throw InputError(fmt::format("choice \"{}\": in scenario {}, {} {}", choice.id, name_,
                                 path.empty() ? "the scenario" : fmt::format("\"{}\"", path), problem));
  }

  Json scenario_;  ///< with every default, so that every field exists
  std::string name_;
  Json values_ = Json::object();  ///< texts by path, in the order of their first change
};

std::string fields_text(const OpenChoice& choice) {
  if (choice.fields.empty()) return "read by rules";
  std::vector<std::string> texts;
  for (const ChosenField& field : choice.fields) {
    texts.push_back(fmt::format("`{}{}` of {}", field.path, field.times ? " ×" : "", fmt::join(field.scenarios, ", ")));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

std::string range_text(const OpenChoice& choice) {
  if (!choice.range) return fmt::format("{}", fmt::join(choice.options, ", "));
  return fmt::format("{} ... {}{}", choice.range->first, choice.range->second, choice.logarithmic ? " (log)" : "");
}

}  // namespace

bool names_scenario(const std::string& pattern, const std::string& scenario) {
  return ::fnmatch(pattern.c_str(), scenario.c_str(), 0) == 0;
}

Choices::Choices(const std::filesystem::path& file) {
  std::string at = "/choices";
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
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
  std::vector<std::string> values;
  for (const OpenChoice& choice : all_) values.push_back(choice.value);
  return values;
}

std::vector<std::string> Choices::overrides(const Scenario& scenario, std::span<const std::string> values) const {
  Changes changes(effective_scenario(scenario, scenario.directory), scenario.name);
  for (std::size_t i = 0; i < all_.size(); ++i) {
    for (const ChosenField& field : all_[i].fields) {
      if (concerns(field, scenario.name)) changes.apply(all_[i], field, values[i]);
    }
  }
  return changes.overrides();
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
    const bool sets = std::any_of(all_[i].fields.begin(), all_[i].fields.end(), [&](const ChosenField& field) {
      return std::any_of(scenarios.begin(), scenarios.end(), [&](const auto& s) { return concerns(field, s); });
    });
    const bool named = rule.find(name + ">") != std::string::npos || rule.find(name + ".mean") != std::string::npos;
    if (sets || (all_[i].fields.empty() && named)) reaching += texts_[i];
  }
  return reaching.empty() ? "" : hash_text(hash_of(reaching));
}

std::string Choices::markdown() const {
  std::string text =
      "| id | choice | the thesis | value | plausible | seen results? | why | fields |\n|---|---|---|---|---|---|---|---|\n";
  for (const OpenChoice& choice : all_) {
    text += fmt::format("| {} | {} | {} | {}{}{} | {} | {} | {} | {} |\n", choice.id, choice.what, choice.thesis,
                        choice.value, choice.unit.empty() ? "" : " ", choice.unit, range_text(choice), choice.chosen,
                        choice.why, fields_text(choice));
  }
  return text;
}

Json choices_schema() {
  return parse_json(read_text_file(installed_folder("results/reference") / "choices.schema.json", kLargestJsonFile));
}

}  // namespace hapbench
