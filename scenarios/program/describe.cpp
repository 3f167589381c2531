#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>
#include <regex>

#include "algorithms/registry.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/study.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/thesis_claims/ledger.hpp"

/// The commands `list` and `describe`, which show the index and what lies in the folders beside the program.
namespace hapbench {
namespace {

// ---- What lies in the folders beside the program

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

/// A scenario: where its numbers come from, and what its file sets. Throws InputError.
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
  return {fmt::format("claim {}, verdict on record: {}\n{}\n", bold(stdout, said("id")), said("verdict"),
                      wrapped(said("claim"))) +
              facts_text({{"place", said("place")},
                          {"published", said("published")},
                          {"measured", said("measured")},
                          {"rule", said("rule")},
                          {"why", said("why")},
                          {"robustness", robustness_text(claim)},
                          {"scenarios", said("scenarios")}},
                         14) +
              fmt::format("\njudge it again: {} ({} s)\n", said("command"), seconds_text(claim)),
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

/// What the folders beside the program hold: scenarios, studies, claims and choices on record. The files of scenarios
/// are read unless `summaries` is false: a fault of one becomes its summary. Throws InputError.
Index folder_index(bool summaries = true) {
  Index index;
  for (const BundledScenario& bundled : bundled_scenarios()) index.push_back(named_scenario(bundled, summaries));
  for (const BundledStudy& study : bundled_studies())
    index.push_back({"study", study.name, study.summary, [study] { return describe_study(study); }});
  for (const Json& claim : list_on_record("claims"))
    index.push_back({"claim",
                     claim.at("id"),
                     claim.at("claim"),
                     [claim] { return describe_claim(claim); },
                     {{"verdict", claim.at("verdict")}, {"source", claim.at("place")}}});
  for (const Json& choice : list_on_record("choices"))
    index.push_back({"choice", choice.at("id"), "", [choice] { return describe_choice(choice); }});
  return index;
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

/// The bundled scenarios and claims that name a place of the thesis, as "A.2", "Fig. A.2", "Table A.1" or
/// "section 3.4"; a place includes its parts: 3.4 includes 3.4.1, Fig. 2 includes Fig. 2c. None when the name is no
/// place's. Throws InputError for a place that nothing names.
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

// ---- list

/// The kinds that lists have, in their order.
constexpr const char* kListed[] = {"algorithm", "depth model", "stage",    "integrator", "environment", "tool", "hand",
                                   "device",    "preset",      "scenario", "study",      "metric",      "claim"};

Index everything() {
  Index index = program_index(), all;
  std::ranges::move(folder_index(), std::back_inserter(index));
  for (const std::string_view kind : kListed)
    std::ranges::copy_if(index, std::back_inserter(all), [kind](const Named& thing) { return thing.kind == kind; });
  return all;
}

std::string group_of(const Named& thing) {
  return thing.more.value("group", "");
}

std::string plural(const std::string& kind) {
  return kind == "study" ? "studies" : kind + "s";
}

/// The kinds, and the groups of scenarios.
std::vector<std::string> sections_of(const Index& all) {
  std::vector<std::string> names;
  for (const Named& thing : all) {
    for (const std::string& name : {thing.kind, group_of(thing)}) {
      if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

constexpr std::size_t kColumn = 34;  // of the summaries

/// The first sentence of a summary, up to a semicolon or a colon that is not near its beginning, cut to what the line
/// holds.
std::string short_summary(const std::string& text) {
  std::size_t end = std::min(text.find("; "), text.find(": ", 20));
  for (std::size_t dot = text.find('.'); dot < end; dot = text.find('.', dot + 1)) {
    const bool is_last = dot + 1 == text.size();
    if (is_last || (text[dot + 1] == ' ' && !text.substr(0, dot).ends_with("Fig"))) end = dot;
  }
  const std::string sentence = text.substr(0, end);
  const std::size_t room = std::max<std::size_t>(output_width(), kColumn + 10) - kColumn;
  if (sentence.size() <= room) return sentence;
  return sentence.substr(0, sentence.rfind(' ', room - 4)) + " ...";
}

/// A scenario's name without the algorithm at its end, which scenarios of one scene have in common.
std::string scene_of(const std::string& name) {
  std::size_t longest = 0;
  for (const AlgorithmEntry& entry : algorithms()) {
    const std::string end = std::string("_") + entry.info->name;
    if (name.ends_with(end)) longest = std::max(longest, end.size());
  }
  return name.substr(0, name.size() - longest);
}

/// The line of a thing. Scenarios that are one scene under several algorithms share the line of the first.
std::string entry_of(const Index& all, const Named& first) {
  if (first.kind == "claim")
    return entry(fmt::format("{:<5}{}", first.name, first.more.at("verdict").get<std::string>()), first.summary, 2,
                 kColumn, output_width());
  const std::string scene = scene_of(first.name);
  std::vector<std::string> algorithms;
  for (const Named& thing : all) {
    if (thing.kind == "scenario" && group_of(thing) == group_of(first) && thing.name != scene &&
        scene_of(thing.name) == scene)
      algorithms.push_back(thing.name.substr(scene.size() + 1));
  }
  if (first.kind != "scenario" || first.name == scene || algorithms.size() < 2)
    return entry(first.name, short_summary(first.summary), 2, kColumn, output_width());
  if (!first.name.ends_with("_" + algorithms.front())) return "";  // on the line of the first
  return entry(scene + "_*", short_summary(first.summary), 2, kColumn, output_width()) +
         wrapped(fmt::format("*: {}", fmt::join(algorithms, ", ")), kColumn);
}

std::string list_text(const Index& all) {
  std::string text, title;
  for (const Named& thing : all) {
    const std::string group = group_of(thing), of = group.empty() ? plural(thing.kind) : "scenarios: " + group;
    if (of != title) text += (title.empty() ? "" : "\n") + bold(stdout, of) + "\n";
    title = of;
    text += entry_of(all, thing);
  }
  return text + "\n\"hapbench describe NAME\" explains each.\n";
}

struct ListOptions {
  std::string what;
  std::string grep;
  OutputOptions output;
};

int list(const ListOptions& options) {
  Index all = everything();
  if (!options.what.empty()) {
    // "scenario" and "depth model" are accepted like "scenarios" and "depth_models".
    std::string what = options.what;
    std::replace(what.begin(), what.end(), '_', ' ');
    const std::vector<std::string> sections = sections_of(all);
    for (const std::string& section : sections) {
      if (what == plural(section)) what = section;
    }
    require_valid_name("got", what, sections);
    std::erase_if(all, [&what](const Named& thing) { return thing.kind != what && group_of(thing) != what; });
  }
  // There are so many metrics and claims that they are only shown on request.
  const bool of_everything = options.what.empty() && options.grep.empty();
  if (of_everything)
    std::erase_if(all, [](const Named& thing) { return thing.kind == "metric" || thing.kind == "claim"; });
  const std::string pattern = lower_case(options.grep);
  std::erase_if(all, [&pattern](const Named& thing) {
    const std::string text = thing.name + " " + thing.summary + " " + thing.more.value("source", "");
    return lower_case(text).find(pattern) == std::string::npos;
  });
  if (all.empty()) throw InputError(fmt::format("--grep: nothing has \"{}\" in its name or text", options.grep));
  Json json = Json::array();
  for (const Named& thing : all) {
    Json& entry = json.emplace_back(Json{{"kind", thing.kind}, {"name", thing.name}, {"summary", thing.summary}});
    entry.update(thing.more);
  }
  print(options.output,
        list_text(all) + (of_everything ? "\"hapbench list metrics\" and \"list claims\" show more.\n" : ""), json);
  return kSuccess;
}

// ---- describe

/// True for a file's name, in which capital letters stand for any characters: stability_map_NAME.csv.
bool is_named(std::string_view file, std::string_view name) {
  const auto is_capital = [](unsigned char c) { return std::isupper(c) != 0; };
  const auto first = std::find_if(file.begin(), file.end(), is_capital);
  const auto last = std::find_if(file.rbegin(), file.rend(), is_capital).base();
  if (first == file.end() || file == name) return file == name;
  const std::string_view before(file.begin(), first), after(last, file.end());
  return name.size() > before.size() + after.size() && name.starts_with(before) && name.ends_with(after);
}

bool is_called(const Named& thing, std::string_view name) {
  return thing.kind.starts_with("file") ? is_named(thing.name, name) : thing.name == name;
}

/// A heading in lower case, without blanks and line breaks.
std::string plain(std::string_view text) {
  std::string plain = lower_case(text);
  std::erase_if(plain, [](unsigned char c) { return std::isspace(c); });
  return plain;
}

/// A heading is known by all of it, as ">30Hz rms N", and by its first line, ">30Hz".
bool is_heading(const Named& thing, std::string_view name) {
  const std::string_view title = thing.name;
  return thing.kind == "heading" &&
         (plain(name) == plain(title) || plain(name) == plain(title.substr(0, title.find('\n'))));
}

using Meant = std::function<bool(const Named&)>;

std::vector<Description> described(const Index& index, const Meant& is_meant) {
  std::vector<Description> found;
  for (const Named& thing : index)
    if (is_meant(thing)) found.push_back(thing.describe());
  return found;
}

/// What the headings of that name mean, each meaning once.
std::vector<Description> described_headings(const Index& index, const std::string& name) {
  std::vector<Description> found;
  for (const Named& heading : index) {
    if (!is_heading(heading, name)) continue;
    const auto meant =
        std::ranges::find_if(index, [&heading](const Named& thing) { return is_called(thing, heading.summary); });
    Description meaning = meant == index.end() ? heading.describe() : meant->describe();
    if (std::ranges::find(found, meaning.text, &Description::text) == found.end()) found.push_back(std::move(meaning));
  }
  return found;
}

[[noreturn]] void refuse(const std::string& name, const Index& index, const Index& in_folders) {
  std::vector<std::string> names;
  for (const Index* known : {&index, &in_folders})
    for (const Named& thing : *known)
      if (thing.kind != "heading") names.push_back(thing.name);
  throw InputError(
      fmt::format("nothing is called \"{}\"{}; \"hapbench list\" shows the names, \"hapbench describe scenario\" "
                  "the fields of a scenario file",
                  name, nearest_name_hint(name, names)));
}

std::vector<Description> meanings_of(const std::string& name) {
  const Index index = program_index();
  std::vector<Description> found =
      described(index, [&](const Named& thing) { return thing.kind != "heading" && is_called(thing, name); });
  if (found.empty()) found = described_headings(index, name);
  if (!found.empty()) return found;
  if (const std::optional<Description> place = describe_place(name)) return {*place};
  // Fields of that name in any section: "torque" for record.torque.
  found =
      described(index, [&](const Named& thing) { return thing.kind == "field" && thing.name.ends_with("." + name); });
  if (!found.empty()) return found;
  const Index in_folders = folder_index(false);
  found = described(in_folders, [&](const Named& thing) {
    return thing.name == name || (thing.kind == "claim" && lower_case(thing.name) == lower_case(name));
  });
  if (!found.empty()) return found;
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored)) refuse(name, index, in_folders);
  return {describe_scenario(find_scenario(name))};
}

struct DescribeOptions {
  std::string name;
  OutputOptions output;
};

int describe(const DescribeOptions& options) {
  const Description d = joined(meanings_of(options.name));
  OutputOptions output = options.output;
  output.json |= d.text.empty();
  print(output, d.text, d.json);
  return kSuccess;
}

}  // namespace

void add_list(CommandLine& line) {
  auto [command, options] = line.command(
      "list",
      "List algorithms, models, integrators, environments, tools, hands, devices, scenarios, studies, metrics and claims",
      list);
  command.add(
      "what", options.what,
      "one kind alone, such as algorithms, depth_models, hands, metrics or claims, or one group of scenarios, such "
      "as thesis");
  command.add("--grep", options.grep, "only things with this text in their name, description or source");
}

void add_describe(CommandLine& line) {
  auto [command, options] = line.command(
      "describe",
      "Explain an algorithm, a depth model, an integrator, an environment, a field, a scenario, a metric, a column or "
      "file of the results, a word or heading that the program prints, a claim, a choice on record or a place of the thesis",
      describe);
  command.add(
      "name", options.name,
      "a name that \"list\" shows, a field such as rendering.limits, \"scenario\" (all fields), \"schema\", "
      "\"choices_schema\", \"stability\", \"diagnosis\"; a metric or a column, \"metrics\" or \"columns\" for all of them, a "
      "heading such as \">30Hz rms N\", or a file such as trajectory.csv; a claim such as C5, a choice such as "
      "planar.first_tilt or a place such as \"Fig. A.2\"",
      {.required = true});
}

}  // namespace hapbench
