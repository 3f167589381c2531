#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <regex>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/study.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/thesis_claims/ledger.hpp"

/// Names of what lies in the folders beside the program: scenarios, studies, and the thesis's claims, choices and
/// places.
namespace hapbench {
namespace {

/// Appends a line "time.steps=2000" for each value in a scenario's text.
void add_assignments(std::string& text, const std::string& path, const Json& value) {
  if (!value.is_object()) {
    text += wrapped(fmt::format("{}={}", path, shown(value)), 6).erase(4, 2);
    return;
  }
  for (const auto& field : value.items()) {
    if (field.key() == "$schema" || field.key() == "description" || field.key() == "source") continue;
    add_assignments(text, path.empty() ? field.key() : path + "." + field.key(), field.value());
  }
}

Named named_scenario(const BundledScenario& bundled, bool summary) {
  Named named{"scenario",
              bundled.name,
              "",
              [file = bundled.file] { return describe_scenario(file); },
              {{"group", bundled.group}, {"source", ""}}};
  if (!summary) return named;
  try {
    const Scenario scenario = load_scenario(bundled.file).scenario;
    named.summary = scenario.description;
    named.more["source"] = scenario.source;
  } catch (const InputError& error) {
    named.summary = error.what();
  }
  return named;
}

/// The command that a study stands for, and its file as it is.
Description describe_study(const BundledStudy& study) {
  const std::string text = read_text_file(study.file, kLargestJsonFile);
  return {fmt::format("study {}\n{}\n{}\n{}\n  asked by: hapbench {} {}\n", bold(stdout, study.name),
                      wrapped(study.summary), study.file.string(), text, study.ask, study.name),
          {{"kind", "study"}, {"name", study.name}, {"file", study.file.string()}, {"study", parse_json(text)}}};
}

/// A list of results/reference/LIST.json.
Json list_on_record(const std::string& list) {
  const std::filesystem::path file = installed_folder("results/reference") / (list + ".json");
  try {
    return parse_json(read_text_file(file, kLargestJsonFile)).at(list);
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

/// A value as text; numbers of an array are the ends of a range. Empty where there is none.
std::string text_in(const Json& object, const char* field) {
  const Json value = object.value(field, Json(""));
  const auto text_of = [](const Json& one) { return one.is_string() ? one.get<std::string>() : one.dump(); };
  if (!value.is_array()) return text_of(value);
  std::vector<std::string> texts;
  for (const Json& one : value) texts.push_back(text_of(one));
  return fmt::format("{}", fmt::join(texts, !value.empty() && value.front().is_number() ? " ... " : ", "));
}

Description describe_claim(const Json& claim) {
  const auto said = [&claim](const char* field) { return text_in(claim, field); };
  return {fmt::format("claim {}, verdict on record: {}\n{}\n", bold(stdout, said("id")), verdicts_text(claim),
                      wrapped(said("claim"))) +
              facts_text({{"place", said("place")},
                          {"published", said("published")},
                          {"measured", said("measured")},
                          {"rule", said("rule")},
                          {"why", said("why")},
                          {"robustness", robustness_text(claim)},
                          {"scenarios", said("scenarios")}},
                         14) +
              fmt::format("\njudge it again: hapbench reproduce --only {}\n", said("id")),
          claim};
}

Description describe_choice(const Json& choice) {
  const auto said = [&choice](const char* field) { return text_in(choice, field); };
  const std::string unit = said("unit");
  std::string text = fmt::format("choice {}, on record\n{}\n", bold(stdout, said("id")), wrapped(said("what"))) +
                     facts_text({{"value", said("value") + (unit.empty() ? "" : " " + unit)},
                                 {"the thesis", said("thesis")},
                                 {"plausible", said("range")},
                                 {"options", said("options")},
                                 {"scale", said("scale")},
                                 {"why", said("why")},
                                 {"chosen", said("chosen") + " results were seen"}},
                                14);
  for (const Json& field : choice.value("fields", Json::array())) {
    text +=
        facts_text({{"sets", fmt::format("{}{} of {}", text_in(field, "path"),
                                         field.value("times", false) ? " (times)" : "", text_in(field, "scenarios"))}},
                   14);
  }
  return {
      text +
          "\nwhat it does to the verdicts: results/reference/claims.md; \"hapbench reproduce --choices\" judges by others\n",
      choice};
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

/// True for a source that names the place or a part of it, as "3.3, Fig. 4, C.2a" does: a kind holds until another word
/// comes. Other numbers in the source are taken for places, too.
bool names_place(const std::string& source, const Place& asked) {
  static const std::regex kParts(R"(([A-F]\.\d+|\d+)(\.\d+)*[a-d]?\b|[A-Za-z]+)");
  std::string kind = "section";
  for (std::sregex_iterator found(source.begin(), source.end(), kParts), end; found != end; ++found) {
    const std::string word = found->str();
    if (!(*found)[1].matched) {
      const std::string announced = place_kind(word);
      if (word != "and") kind = announced.empty() ? "section" : announced;
      continue;
    }
    if ((!asked.kind.empty() && kind != asked.kind) || !word.starts_with(asked.number)) continue;
    const std::string part = word.substr(asked.number.size());
    if (part.empty() || part[0] == '.' || std::isalpha(static_cast<unsigned char>(part[0]))) return true;
  }
  return false;
}

}  // namespace

Description describe_scenario(const std::filesystem::path& file) {
  const ScenarioText given = read_scenario_text(file);
  const LoadedScenario loaded = load_scenario(given, {});
  const Scenario& scenario = loaded.scenario;
  std::string text = fmt::format("scenario {}\n", bold(stdout, scenario.name));
  if (!scenario.description.empty()) text += wrapped(scenario.description);
  text += fmt::format("\n  file    {}\n", file.string());  // whole, to be copied
  text += facts_text({{"source", scenario.source}}, 10);
  text += "\n  set (\"hapbench describe scenario\" explains the fields, --json has all with their defaults)\n";
  add_assignments(text, "", given.json);
  return {text, effective_scenario(scenario, scenario.directory)};
}

Index folder_index(bool summaries) {
  Index index;
  for (const BundledScenario& bundled : bundled_scenarios()) index.push_back(named_scenario(bundled, summaries));
  for (const BundledStudy& study : bundled_studies())
    index.push_back({"study", study.name, study.summary, [study] { return describe_study(study); }});
  for (const Json& claim : list_on_record("claims"))
    index.push_back(
        {"claim",
         claim.at("id"),
         claim.at("claim"),
         [claim] { return describe_claim(claim); },
         {{"verdict", claim.at("verdict")}, {"majority", claim.at("majority")}, {"source", claim.at("place")}}});
  for (const Json& choice : list_on_record("choices"))
    index.push_back({"choice", choice.at("id"), "", [choice] { return describe_choice(choice); }});
  return index;
}

std::optional<Description> describe_place(const std::string& name) {
  const std::optional<Place> place = asked_place(name);
  if (!place) return std::nullopt;
  const std::string title = place->kind + (place->kind.empty() ? "" : " ") + place->number;
  std::string scenarios, claims;
  Json json = {{"kind", "place"}, {"name", title}, {"scenarios", Json::array()}, {"claims", Json::array()}};
  for (const Named& thing : folder_index()) {
    const std::string source = thing.more.value("source", "");
    if (!names_place(source, *place)) continue;
    const bool is_claim = thing.kind == "claim";
    (is_claim ? claims : scenarios) += is_claim
                                           ? entry(thing.name, fmt::format("{} ({})", thing.summary, source), 4, 10)
                                           : entry(thing.name, source, 4, 44);
    json[is_claim ? "claims" : "scenarios"].push_back(thing.name);
  }
  if (scenarios.empty() && claims.empty())
    throw InputError(fmt::format("no bundled scenario and no claim names {} of the thesis", title));
  return Description{fmt::format("{} of the thesis\n\n  scenarios\n{}\n  claims\n{}", bold(stdout, title),
                                 scenarios.empty() ? "    none\n" : scenarios, claims.empty() ? "    none\n" : claims),
                     json};
}

}  // namespace hapbench
