#include "scenarios/thesis_claims/choices.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

#include "results/io/json_text.hpp"
#include "scenarios/batch/axis.hpp"
#include "scenarios/description/reader.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

constexpr NumberRange kAnyNumber = {-1e12, 1e12, ""};
constexpr std::size_t kLongest = 2000;
constexpr std::size_t kMostChoices = 1000;

constexpr Choice<OpenChoice::Scale> kScales[] = {{"linear", OpenChoice::Scale::linear},
                                                 {"log", OpenChoice::Scale::log}};
constexpr Choice<OpenChoice::Chosen> kChosen[] = {{"before", OpenChoice::Chosen::before},
                                                  {"after", OpenChoice::Chosen::after}};

[[noreturn]] void refuse(const Fields& f, const char* field, const std::string& problem) {
  throw InputError(InputError::Kind::relation, member(f.at(), field), problem);
}

/// Refuses texts that a CSV cell or a dotted path cannot hold without quotes.
void check_plain(const Fields& f, const char* field, const std::string& text) {
  const auto is_odd = [](unsigned char c) { return c <= 0x20 || c == 0x7f || c == '"' || c == ','; };
  if (!text.empty() && std::none_of(text.begin(), text.end(), is_odd)) return;
  refuse(f, field,
         fmt::format("got \"{}\"; allowed: a text without spaces, commas, quotes and control characters", text));
}

/// The value is a number beside a range and a text beside options. The reader asks for the one that belongs there; the
/// schema allows both.
void describe_value(Fields& f, OpenChoice& choice, bool is_text) {
  const auto number = [&choice](Fields& v) {
    double value = 0.0;
    if (const auto* held = std::get_if<double>(&choice.value)) value = *held;
    v.number(value, kAnyNumber);
    if (v.reads()) choice.value = value;
  };
  const auto text = [&choice](Fields& v) {
    std::string value;
    if (const auto* held = std::get_if<std::string>(&choice.value)) value = *held;
    v.text(value, kLongest);
    if (v.reads()) choice.value = value;
  };
  f.field("value", "on record: what the scenarios have", Presence::required, [&](Fields& v) {
    if (!v.reads()) return v.one_or_list(is_text, number, text);
    is_text ? text(v) : number(v);
  });
}

void check_range(const Fields& f, const OpenChoice& choice) {
  const auto [low, high] = *choice.range;
  const double value = std::get<double>(choice.value);
  if (!(low < high)) refuse(f, "range", fmt::format("got {} and {}; allowed: the smaller number first", low, high));
  if (choice.scale == OpenChoice::Scale::log && !(low > 0.0)) {
    refuse(f, "range", fmt::format("got {} for an end of a logarithmic range; allowed: numbers > 0", low));
  }
  if (value < low || value > high) {
    refuse(f, "value", fmt::format("got {}; allowed: a number of the range {} ... {}", value, low, high));
  }
}

void check_choice(const Fields& f, const OpenChoice& choice) {
  check_plain(f, "id", choice.id);
  if (choice.range) check_range(f, choice);
  if (choice.options) {
    for (const std::string& option : *choice.options) check_plain(f, "options", option);
    require_valid_name(member(f.at(), "value") + ": got", std::get<std::string>(choice.value), *choice.options);
    if (choice.scale == OpenChoice::Scale::log) {
      refuse(f, "scale", "got \"log\" beside options; allowed: \"log\" beside a range");
    }
  }
  if (choice.fields.empty() && choice.options) {
    const auto& options = *choice.options;
    if (!std::all_of(options.begin(), options.end(), [](const auto& o) { return finite_number(o).has_value(); }))
      refuse(f, "options", "got a text of a choice without fields; allowed: numbers");
  }
  const bool times =
      std::any_of(choice.fields.begin(), choice.fields.end(), [](const ChosenField& c) { return c.times; });
  if (!times) return;
  if (choice.options) refuse(f, "fields", "got \"times\" beside options; allowed: beside a range");
  if (const double value = std::get<double>(choice.value); value != 1.0) {
    refuse(f, "value", fmt::format("got {} of a choice that multiplies; allowed: 1", value));
  }
}

/// The whole file.
struct ChoicesFile {
  std::vector<OpenChoice> choices;
};

}  // namespace

static void describe(Fields& f, ChosenField& field) {
  f.list(
      "scenarios", field.scenarios, {1, 100}, "names of bundled scenarios; * stands for any characters",
      [](Fields& s, std::string& name) { s.text(name, kLongest); }, Presence::required);
  f.text("path", field.path, kLongest, "of the field, as in --set; * stands for every index of a list",
         Presence::required);
  f.boolean("times", field.times, "the choice multiplies what the scenario has; its value on record is 1");
}

static void describe(Fields& f, OpenChoice& choice) {
  f.text("id", choice.id, kLongest, "name, as in task2.hand_angle", Presence::required);
  f.text("what", choice.what, kLongest, "was chosen", Presence::required);
  f.text("thesis", choice.thesis, kLongest, "what the thesis says of it, or that it does not", Presence::required);
  f.if_any("range", choice.range, "plausible values", [](Fields& r, std::pair<double, double>& range) {
    r.pair(
        "a pair of numbers [least, greatest]", [&](Fields& a) { a.number(range.first, kAnyNumber); },
        [&](Fields& b) { b.number(range.second, kAnyNumber); });
  });
  f.if_any("options", choice.options, "plausible values, as texts for --set",
           [](Fields& o, std::vector<std::string>& options) {
             o.list(options, {2, 100}, [](Fields& t, std::string& text) { t.text(text, kLongest); });
           });
  f.exactly_one_of("range", "options");
  describe_value(f, choice, f.given("options"));
  f.text("unit", choice.unit, kLongest, "of the number; none for a ratio or options");
  f.choice("scale", choice.scale, kScales, "scale", "of the range: values are sampled evenly in it");
  f.choice("chosen", choice.chosen, kChosen, "time", "before or after results were seen", Presence::required);
  f.text("why", choice.why, kLongest, "this value", Presence::required);
  f.list("fields", choice.fields, {1, 100}, "that the choice sets; none: rules read the number by the choice's id",
         [](Fields& c, ChosenField& field) { c.object(field); });
  if (f.reads()) check_choice(f, choice);
}

static void describe(Fields& f, ChoicesFile& file) {
  f.ignored("$schema", "for editors");
  f.list(
      "choices", file.choices, {1, kMostChoices}, "all choices on record",
      [](Fields& c, OpenChoice& choice) { c.object(choice); }, Presence::required);
  if (!f.reads()) return;
  std::set<std::string> ids;
  for (std::size_t i = 0; i < file.choices.size(); ++i) {
    if (ids.insert(file.choices[i].id).second) continue;
    throw InputError(InputError::Kind::relation, member(element(member(f.at(), "choices"), i), "id"),
                     fmt::format("got \"{}\" twice; allowed: each once", file.choices[i].id));
  }
}

std::vector<OpenChoice> read_choices(const Json& json) {
  ChoicesFile file;
  Reader reader(json, "");
  reader.object(file);
  return file.choices;
}

Json choices_schema() {
  ChoicesFile defaults;
  SchemaWriter writer;
  writer.object(defaults);
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                 {"title", "Choices on record"},
                 {"description", "What the thesis leaves open, and what the bundled scenarios chose."}};
  schema.update(writer.schema());
  return schema;
}

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

  Json scenario_;  ///< with every default, so that every field exists
  std::string name_;
  std::vector<std::pair<std::string, std::string>> values_;  ///< by path, in the order of their first change
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
    for (const Json& choice : json.at("choices")) texts_.push_back(json_text(choice));
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

std::vector<std::string> Choices::values_on_record() const {
  std::vector<std::string> values;
  for (const OpenChoice& choice : all_) values.push_back(value_text(choice));
  return values;
}

std::vector<Axis> Choices::axes() const {
  std::vector<Axis> axes;
  for (const OpenChoice& choice : all_) {
    Axis& axis = axes.emplace_back(Axis{choice.id, choice.options.value_or(std::vector<std::string>())});
    if (choice.range)
      axis.range = Range{choice.range->first, choice.range->second, choice.scale == OpenChoice::Scale::log};
  }
  return axes;
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
    text +=
        fmt::format("| {} | {} | {} | {}{}{} | {} | {} | {} | {} |\n", choice.id, choice.what, choice.thesis,
                    value_text(choice), choice.unit.empty() ? "" : " ", choice.unit, range_text(choice),
                    choice.chosen == OpenChoice::Chosen::before ? "before" : "after", choice.why, fields_text(choice));
  }
  return text;
}

}  // namespace hapbench
