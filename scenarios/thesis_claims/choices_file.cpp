#include "scenarios/thesis_claims/choices_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scenarios/description/reader.hpp"
#include "scenarios/description/writer.hpp"

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

/// A text that a CSV cell and a dotted path can hold without quotes.
void check_plain(const Fields& f, const char* field, const std::string& text) {
  const auto is_odd = [](unsigned char c) { return c <= 0x20 || c == 0x7f || c == '"' || c == ','; };
  if (!text.empty() && std::none_of(text.begin(), text.end(), is_odd)) return;
  refuse(f, field,
         fmt::format("got \"{}\"; allowed: a text without spaces, commas, quotes and control characters", text));
}

/// A number beside a range, a text beside options. A reader asks for the one that belongs there; a schema allows both.
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
  f.list(
      "fields", choice.fields, {1, 100}, "that the choice sets", [](Fields& c, ChosenField& field) { c.object(field); },
      Presence::required);
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

}  // namespace hapbench
