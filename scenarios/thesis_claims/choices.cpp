#include "scenarios/thesis_claims/choices.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

#include "results/io/json_text.hpp"
#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis_claims/choices_file.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

std::string number_text(double number) {
  return std::string(std::string_view(NumberText(number)));
}

std::string value_text(const OpenChoice& choice) {
  const auto* number = std::get_if<double>(&choice.value);
  return number != nullptr ? number_text(*number) : std::get<std::string>(choice.value);
}

bool concerns(const ChosenField& field, const std::string& scenario) {
  return std::any_of(field.scenarios.begin(), field.scenarios.end(),
                     [&scenario](const std::string& pattern) { return names_scenario(pattern, scenario); });
}

/// Changes a scenario's fields and remembers what it changed.
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
          set(path, text);
        },
        choice);
  }

  std::vector<std::string> overrides() const {
    std::vector<std::string> texts;
    for (const auto& [path, value] : values_) texts.push_back(path + "=" + value);
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

  void set(const std::string& path, const std::string& value) {
    const auto found =
        std::find_if(values_.begin(), values_.end(), [&path](const auto& entry) { return entry.first == path; });
    if (found == values_.end()) {
      values_.emplace_back(path, value);
    } else {
      found->second = value;
    }
  }

  Json scenario_;  ///< with every default, so that every field is there
  std::string name_;
  std::vector<std::pair<std::string, std::string>> values_;  ///< by path, in the order of their first change
};

std::string fields_text(const OpenChoice& choice) {
  std::vector<std::string> texts;
  for (const ChosenField& field : choice.fields) {
    texts.push_back(fmt::format("`{}{}` of {}", field.path, field.times ? " ×" : "", fmt::join(field.scenarios, ", ")));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

std::string range_text(const OpenChoice& choice) {
  if (choice.options) return fmt::format("{}", fmt::join(*choice.options, ", "));
  return fmt::format("{} ... {}{}", choice.range->first, choice.range->second,
                     choice.scale == OpenChoice::Scale::log ? " (log)" : "");
}

}  // namespace

bool names_scenario(std::string_view pattern, std::string_view scenario) {
  const std::size_t star = pattern.find('*');
  if (star == std::string_view::npos) return pattern == scenario;
  if (!scenario.starts_with(pattern.substr(0, star))) return false;
  for (std::size_t from = star; from <= scenario.size(); ++from) {
    if (names_scenario(pattern.substr(star + 1), scenario.substr(from))) return true;
  }
  return false;
}

Choices::Choices(const std::filesystem::path& file) {
  try {
    const Json json = parse_json(read_text_file(file, kLargestJsonFile));
    all_ = read_choices(json);
    hash_ = hash_text(hash_of(json_text(json)));
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

std::vector<std::string> Choices::values_on_record() const {
  std::vector<std::string> values;
  for (const OpenChoice& choice : all_) values.push_back(value_text(choice));
  return values;
}

std::vector<std::string> Choices::values_at(std::span<const double> point) const {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    const OpenChoice& choice = all_[i];
    Axis axis{choice.id, choice.options.value_or(std::vector<std::string>()), {}};
    if (choice.range)
      axis.range = Range{choice.range->first, choice.range->second, choice.scale == OpenChoice::Scale::log};
    values.push_back(value_at(axis, point[i]));
  }
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

std::string Choices::markdown() const {
  std::string text =
      "| id | choice | the thesis | value | plausible | seen results? | why | fields |\n|---|---|---|---|---|---|---|---|\n";
  for (const OpenChoice& choice : all_) {
    text +=
        fmt::format("| {} | {} | {} | {}{}{} | {} | {} | {} | {} |\n", choice.id, choice.what, choice.thesis,
                    value_text(choice), choice.unit.empty() ? "" : " ", choice.unit, range_text(choice),
                    choice.chosen == OpenChoice::Chosen::before ? "before" : "after", choice.why, fields_text(choice));
  }
  return text;
}

}  // namespace hapbench
