#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <regex>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/thesis_claims/ledger.hpp"

namespace hapbench {
namespace {

Description describe_claim(const Json& claim) {
  const auto said = [&claim](const char* field) { return claim.at(field).get<std::string>(); };
  std::string text = fmt::format("claim {}, verdict on record: {}\n{}\n", bold(stdout, said("id")),
                                 verdicts_text(claim), wrapped(said("claim")));
  const std::vector<std::string> scenarios = claim.at("scenarios");
  for (const auto& [title, value] : {std::pair{"place", said("place")}, std::pair{"published", said("published")},
                                     std::pair{"measured", said("measured")}, std::pair{"rule", said("rule")},
                                     std::pair{"why", said("why")}, std::pair{"robustness", robustness_text(claim)},
                                     std::pair{"scenarios", fmt::format("{}", fmt::join(scenarios, ", "))}})
    if (!value.empty()) text += entry(title, value, 2, 14);
  return {text + fmt::format("\njudge it again: hapbench reproduce --only {}\n", said("id")), claim};
}

/// A place of the thesis: "Fig. A.2" is {"Fig.", "A.2"}.
struct Place {
  std::string kind;  ///< "Fig.", "Table" or "section"
  std::string number;
};

/// The kind of place that a word announces; empty for any other word.
std::string place_kind(const std::string& word) {
  const std::string lower = lower_case(word);
  if (lower == "fig" || lower == "figs" || lower == "figure") return "Fig.";
  if (lower == "table" || lower == "tables") return "Table";
  return lower == "section" ? "section" : "";
}

/// The places that a source names, as in "3.3, Fig. 4, C.2a": a kind holds until another word comes. Other numbers in
/// the source are taken for places, too.
std::vector<Place> places_in(const std::string& source) {
  static const std::regex kParts(R"(([A-F]\.\d+|\d+)(\.\d+)*[a-d]?\b|[A-Za-z]+)");
  std::vector<Place> places;
  std::string kind = "section";
  for (std::sregex_iterator word(source.begin(), source.end(), kParts), end; word != end; ++word) {
    if ((*word)[1].matched) {
      places.push_back({kind, word->str()});
    } else if (word->str() != "and") {
      const std::string announced = place_kind(word->str());
      kind = announced.empty() ? "section" : announced;
    }
  }
  return places;
}

/// Reads a place, of any kind where none is given, also from the name of a figure's file such as
/// figure_A.4_springs.svg. None when the name is not a place's.
std::optional<Place> asked_place(const std::string& name) {
  static const std::regex kPlace(
      R"((?:(fig|figs|figure|table|section)[._ ]*)?((?:[a-f]\.)?\d+(?:\.\d+)*[a-d]?)(?:_[a-z_]+)?(?:\.(?:svg|png|pdf))?)",
      std::regex::icase);
  std::smatch parts;
  if (!std::regex_match(name, parts, kPlace)) return std::nullopt;
  Place place{parts[1].matched ? place_kind(parts[1]) : "", parts[2]};
  // A plain number could mean anything.
  if (place.kind.empty() && place.number.find('.') == std::string::npos) return std::nullopt;
  if (place.number.find('.') == 1) place.number[0] = static_cast<char>(std::toupper(place.number[0]));
  return place;
}

bool names_place(const std::string& source, const Place& asked) {
  const std::vector<Place> places = places_in(source);
  return std::any_of(places.begin(), places.end(), [&asked](const Place& place) {
    if (!asked.kind.empty() && place.kind != asked.kind) return false;
    if (!place.number.starts_with(asked.number)) return false;
    const std::string part = place.number.substr(asked.number.size());
    return part.empty() || part[0] == '.' || std::isalpha(static_cast<unsigned char>(part[0]));
  });
}

Description describe_place(const Place& place) {
  const std::string title = place.kind + (place.kind.empty() ? "" : " ") + place.number;
  std::string scenarios, claims;
  Json json = {{"kind", "place"}, {"name", title}, {"scenarios", Json::array()}, {"claims", Json::array()}};
  for (const BundledScenario& bundled : bundled_scenarios()) {
    const std::string source = load_scenario(bundled.file).scenario.source;
    if (!names_place(source, place)) continue;
    scenarios += entry(bundled.name, source, 4, 44);
    json["scenarios"].push_back(bundled.name);
  }
  for (const Json& claim : claims_on_record()) {
    const std::string of = claim.at("place"), id = claim.at("id"), said = claim.at("claim");
    if (!names_place(of, place)) continue;
    claims += entry(id, fmt::format("{} ({})", said, of), 4, 10);
    json["claims"].push_back(id);
  }
  if (scenarios.empty() && claims.empty())
    throw InputError(fmt::format("no bundled scenario and no claim names {} of the thesis", title));
  return {fmt::format("{} of the thesis\n\n  scenarios\n{}\n  claims\n{}", bold(stdout, title),
                      scenarios.empty() ? "    none\n" : scenarios, claims.empty() ? "    none\n" : claims),
          json};
}

}  // namespace

namespace {

/// A list of results/reference/LIST.json.
Json list_on_record(const std::string& list) {
  const std::filesystem::path file = installed_folder("results/reference") / (list + ".json");
  try {
    return parse_json(read_text_file(file, kLargestJsonFile)).at(list);
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

/// Numbers of an array are the ends of a range.
std::string plain_text(const Json& value) {
  if (!value.is_array()) return value.is_string() ? value.get<std::string>() : value.dump();
  std::vector<std::string> texts;
  for (const Json& one : value) texts.push_back(plain_text(one));
  return fmt::format("{}", fmt::join(texts, value.front().is_number() ? " ... " : ", "));
}

Description describe_choice(const Json& choice) {
  std::string text = fmt::format("choice {}, on record\n{}\n", bold(stdout, plain_text(choice.at("id"))),
                                 wrapped(plain_text(choice.at("what"))));
  const std::string unit = choice.value("unit", "");
  text += entry("value", plain_text(choice.at("value")) + (unit.empty() ? "" : " " + unit), 2, 14);
  for (const auto& [title, field] :
       {std::pair{"the thesis", "thesis"}, std::pair{"plausible", "range"}, std::pair{"options", "options"},
        std::pair{"scale", "scale"}, std::pair{"why", "why"}})
    if (choice.contains(field)) text += entry(title, plain_text(choice.at(field)), 2, 14);
  text += entry("chosen", fmt::format("{} results were seen", plain_text(choice.at("chosen"))), 2, 14);
  for (const Json& field : choice.value("fields", Json::array())) {
    const std::vector<std::string> scenes = field.at("scenarios");
    text += entry("sets",
                  fmt::format("{}{} of {}", plain_text(field.at("path")), field.value("times", false) ? " (times)" : "",
                              fmt::join(scenes, ", ")),
                  2, 14);
  }
  return {
      text +
          "\nwhat it does to the verdicts: results/reference/claims.md; \"hapbench reproduce --choices\" judges by others\n",
      choice};
}

}  // namespace

Json claims_on_record() {
  return list_on_record("claims");
}

std::vector<Description> describe_choice(const std::string& name) {
  for (const Json& choice : list_on_record("choices"))
    if (choice.at("id") == name) return {describe_choice(choice)};
  return {};
}

std::vector<std::string> choice_names() {
  std::vector<std::string> names;
  for (const Json& choice : list_on_record("choices")) names.push_back(choice.at("id"));
  return names;
}

std::vector<Description> describe_thesis(const std::string& name) {
  if (const std::optional<Place> place = asked_place(name)) return {describe_place(*place)};
  const bool may_be_id = !name.empty() && name.size() <= 4;
  if (!may_be_id) return {};
  for (const Json& claim : claims_on_record()) {
    if (lower_case(claim.at("id").get<std::string>()) == lower_case(name)) return {describe_claim(claim)};
  }
  return {};
}

}  // namespace hapbench
