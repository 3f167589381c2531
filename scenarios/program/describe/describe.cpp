#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <regex>

#include "scenarios/input/bundled_files.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/report.hpp"

/// The command `describe`, which explains the index and what lies in the folders beside the program.
namespace hapbench {
namespace {

/// The kinds that lists have, in their order.
constexpr const char* kListed[] = {"algorithm", "depth model", "stage",    "integrator", "environment", "tool", "hand",
                                   "device",    "preset",      "scenario", "study",      "metric",      "claim"};

/// The name of a kind's list: "depth_models".
std::string list_name(const std::string& kind) {
  std::string name = kind == "study" ? "studies" : kind + "s";
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

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
  if (!scenario.source.empty()) text += entry("source", scenario.source, 2, 10);
  text += "\n  set (\"hapbench describe scenario\" explains the fields, --json has all with their defaults)\n";
  add_assignments(text, "", given.json);
  return {text, effective_scenario(scenario, scenario.directory)};
}

/// A fault of the file becomes its summary.
Named named_scenario(const BundledScenario& bundled) {
  Json json;
  try {
    json = read_scenario_text(bundled.file).json;
  } catch (const InputError& error) {
    json = {{"description", error.what()}};
  }
  return {"scenario",
          bundled.name,
          json.value("description", ""),
          [file = bundled.file] { return describe_scenario(file); },
          {{"group", bundled.group}, {"source", json.value("source", "")}}};
}

Description describe_study(const BundledStudy& study) {
  const std::string text = read_text_file(study.file, kLargestJsonFile);
  return {fmt::format("study {}\n{}\n{}\n{}\n  asked by: hapbench {} {}\n", bold(stdout, study.name),
                      wrapped(study.summary), study.file.string(), text, study.ask, study.name),
          {{"kind", "study"}, {"name", study.name}, {"file", study.file.string()}, {"study", parse_json(text)}}};
}

Json list_on_record(const std::string& list) {
  const std::filesystem::path file = installed_folder("results/reference") / (list + ".json");
  return with_file(file, [&] { return read_json(file).at(list); });
}

/// What is on record of a claim or a choice.
Named on_record(const char* kind, const Json& thing) {
  const auto describe = [=] {
    Json titled = {{"kind", fmt::format("{}, on record", kind)}, {"name", thing.at("id")}};
    titled.update(thing);
    if (const Json& counts = thing.value("robustness", Json()); !counts.is_null())
      titled["sureness"] =
          fmt::format("{}: {} of {} readings give this verdict", thing.at("sureness").get<std::string>(),
                      counts.at("holds").dump(), counts.at("judged").dump());
    // The name has the id, and people are told what was measured in a sentence.
    for (const char* member : {"id", "cases", "choices_reach_it", "ours", "robustness", "timing"}) titled.erase(member);
    return Description{thing_text(titled), thing};
  };
  Json more = Json::object();
  if (thing.contains("claim")) more = {{"verdict", thing.at("verdict")}, {"source", thing.at("place")}};
  return {kind, thing.at("id").get<std::string>(), thing.value("claim", ""), describe, more};
}

/// What the folders beside the program hold: scenarios, studies, claims and choices on record. Throws InputError.
Index folder_index() {
  Index index;
  for (const BundledScenario& bundled : bundled_scenarios()) index.push_back(named_scenario(bundled));
  for (const BundledStudy& study : bundled_studies())
    index.push_back({"study", study.name, study.summary, [study] { return describe_study(study); }});
  for (const Json& claim : list_on_record("claims")) index.push_back(on_record("claim", claim));
  for (const Json& choice : list_on_record("choices")) index.push_back(on_record("choice", choice));
  return index;
}

// ---- Places of the thesis

/// A place of the thesis: "Fig. A.2" is {"Fig.", "A.2"}; the kind is "Fig.", "Table" or "section".
struct Place {
  std::string kind, number;
};

/// The kind of place that a word announces. Numbers behind any other word are sections.
std::string place_kind(const std::string& word) {
  const std::string lower = lower_case(word);
  if (lower == "fig" || lower == "figs" || lower == "figure") return "Fig.";
  if (lower == "table" || lower == "tables") return "Table";
  return "section";
}

/// A place, of any kind where none is given, or of a figure's file such as figure_A.4_springs.svg; none of other names.
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
/// comes. Other numbers in the source are also taken for places.
bool names_place(const std::string& source, const Place& asked) {
  static const std::regex kParts(R"(([A-F]\.\d+|\d+)(\.\d+)*[a-d]?\b|[A-Za-z]+)");
  std::string kind = "section";
  for (std::sregex_iterator found(source.begin(), source.end(), kParts), end; found != end; ++found) {
    const std::string word = found->str();
    if (!(*found)[1].matched) {
      if (word != "and") kind = place_kind(word);
      continue;
    }
    if ((!asked.kind.empty() && kind != asked.kind) || !word.starts_with(asked.number)) continue;
    const std::string part = word.substr(asked.number.size());
    if (part.empty() || part[0] == '.' || std::isalpha(static_cast<unsigned char>(part[0]))) return true;
  }
  return false;
}

/// The pictures on record of a figure of the thesis, such as figure_A.2.svg of "A.2".
std::vector<std::filesystem::path> pictures_of(const Place& place) {
  if (!place.kind.empty() && place.kind != "Fig.") return {};
  const std::string figure = place.number.substr(0, place.number.find_last_not_of("abcd") + 1);
  std::vector<std::filesystem::path> pictures;
  std::error_code none;
  for (const auto& entry :
       std::filesystem::directory_iterator(installed_folder("results/reference") / "figures", none)) {
    if ((entry.path().stem().string() + "_").starts_with("figure_" + figure + "_")) pictures.push_back(entry.path());
  }
  std::ranges::sort(pictures);
  return pictures;
}

/// The bundled scenarios and claims that name a place, as "A.2", "Fig. A.2", "Table A.1" or "section 3.4", or a part of
/// it, as 3.4.1 or Fig. 2c. None when the name is no place's. Throws InputError for a place that nothing names.
std::optional<Description> describe_place(const std::string& name) {
  const std::optional<Place> place = asked_place(name);
  if (!place) return std::nullopt;
  const std::string title = place->kind + (place->kind.empty() ? "" : " ") + place->number;
  std::string scenarios, claims;
  Json json = {{"kind", "place"}, {"name", title}, {"scenarios", Json::array()}, {"claims", Json::array()}};
  for (const Named& thing : folder_index()) {
    const std::string source = thing.more.value("source", "");
    if (!names_place(source, *place)) continue;
    if (thing.kind == "claim")
      claims += entry(thing.name, fmt::format("{} ({})", thing.summary, source), 4, 10);
    else
      scenarios += entry(thing.name, source, 4, 44);
    json[list_name(thing.kind)].push_back(thing.name);
  }
  std::string pictures;
  for (const std::filesystem::path& picture : pictures_of(*place)) {
    std::string id = picture.stem().string().substr(std::string_view("figure_").size());
    std::replace(id.begin(), id.end(), '_', '-');
    pictures += fmt::format("    {}\n    drawn anew by scripts/reproduce --figure {}\n", picture.string(), id);
    json["pictures"].push_back(picture.string());
  }
  if (scenarios.empty() && claims.empty() && pictures.empty())
    throw InputError(fmt::format("no bundled scenario and no claim names {} of the thesis", title));
  return Description{fmt::format("{} of the thesis\n\n{}  scenarios\n{}\n  claims\n{}", bold(stdout, title),
                                 pictures.empty() ? "" : "  picture\n" + pictures + "\n",
                                 scenarios.empty() ? "    none\n" : scenarios, claims.empty() ? "    none\n" : claims),
                     json};
}

// ---- Lists

std::string group_of(const Named& thing) {
  return thing.more.value("group", "");
}

/// True for the name of a kind's list. All metrics are told by a section of that name.
bool is_kind(const std::string& name) {
  return name != "metrics" && std::ranges::find(kListed, name, list_name) != std::end(kListed);
}

constexpr std::size_t kColumn = 34;  // of the summaries

/// The first sentence, up to a semicolon or a colon that is not near its beginning, cut to what the line holds.
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

std::string list_text(const Index& all, bool names_alone) {
  std::vector<std::pair<std::string, std::string>> lists;  // title, entries
  for (const Named& thing : all) {
    const std::string group = group_of(thing), title = list_name(thing.kind) + (group.empty() ? "" : " of " + group);
    if (lists.empty() || lists.back().first != title) lists.emplace_back(title, "");
    std::string& entries = lists.back().second;
    const std::string verdict = thing.more.value("verdict", "");  // of a claim, which is told in full
    if (names_alone)
      entries += (entries.empty() ? "" : ", ") + thing.name;
    else if (verdict.empty())
      entries += entry(thing.name, short_summary(thing.summary), 2, kColumn, output_width());
    else
      entries += entry(fmt::format("{:<5}{}", thing.name, verdict), thing.summary, 2, kColumn, output_width());
  }
  std::string text;
  for (const auto& [title, entries] : lists)
    text += (text.empty() ? "" : "\n") + bold(stdout, title) + "\n" + (names_alone ? wrapped(entries) : entries);
  return text;
}

struct DescribeOptions {
  std::string name, grep;
  OutputOptions output;
};

/// Lists what is of a kind or a group, or of each kind but the many metrics and claims the names.
int list(const DescribeOptions& options) {
  const bool of_everything = options.name.empty() && options.grep.empty();
  const std::string pattern = lower_case(options.grep);
  const auto is_asked = [&](const Named& thing) {
    if (of_everything) return thing.kind != "metric" && thing.kind != "claim";
    const std::string text = thing.name + " " + thing.summary + " " + thing.more.value("source", "");
    return (options.name.empty() || list_name(thing.kind) == options.name || group_of(thing) == options.name) &&
           lower_case(text).find(pattern) != std::string::npos;
  };
  Index index = program_index(), all;
  std::ranges::move(folder_index(), std::back_inserter(index));
  for (const std::string_view kind : kListed)
    for (const Named& thing : index)
      if (thing.kind == kind && is_asked(thing)) all.push_back(thing);
  if (all.empty()) throw InputError(fmt::format("--grep: nothing has \"{}\" in its name or text", options.grep));
  Json json = Json::array();
  for (const Named& thing : all) {
    Json& entry = json.emplace_back(Json{{"kind", thing.kind}, {"name", thing.name}, {"summary", thing.summary}});
    entry.update(thing.more);
  }
  const char* more =
      of_everything ? ", \"hapbench describe KIND\" lists a kind with what each is; more kinds: metrics, claims" : "";
  print(options.output,
        list_text(all, of_everything) + "\n" +
            wrapped(fmt::format("\"hapbench describe NAME\" explains each{}.", more), 0),
        json);
  return kSuccess;
}

// ---- describe

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

std::vector<Description> described(const Index& index, const std::function<bool(const Named&)>& is_meant) {
  std::vector<Description> found;
  for (const Named& thing : index)
    if (is_meant(thing)) found.push_back(thing.describe());
  return found;
}

std::vector<Description> described_by_name(const Index& index, std::string_view name) {
  return described(index, [name](const Named& thing) { return thing.kind != "heading" && thing.name == name; });
}

/// What the headings of that name mean, each meaning once.
std::vector<Description> described_headings(const Index& index, const std::string& name) {
  std::vector<Description> found;
  for (const Named& heading : index) {
    if (!is_heading(heading, name)) continue;
    std::vector<Description> meanings = described_by_name(index, heading.summary);
    if (meanings.empty()) meanings.push_back(heading.describe());
    for (Description& meaning : meanings)
      if (std::ranges::find(found, meaning.text, &Description::text) == found.end())
        found.push_back(std::move(meaning));
  }
  return found;
}

[[noreturn]] void refuse(const std::string& name, const Index& index, const Index& in_folders) {
  std::vector<std::string> names = names_of(kListed, list_name);
  for (const Index* known : {&index, &in_folders})
    for (const Named& thing : *known)
      if (thing.kind != "heading") names.push_back(thing.name);
  throw InputError(
      fmt::format("nothing is called \"{}\"{}; \"hapbench describe\" shows the names, \"hapbench describe scenario\" "
                  "the fields of a scenario file, --grep searches",
                  name, nearest_name_hint(name, names)));
}

/// What a name means that the program does not know by itself.
std::vector<Description> other_meanings(const Index& index, const std::string& name) {
  if (const std::optional<Description> place = describe_place(name)) return {*place};
  // Fields of that name in any section: "torque" for record.torque.
  std::vector<Description> found =
      described(index, [&](const Named& thing) { return thing.kind == "field" && thing.name.ends_with("." + name); });
  if (!found.empty()) return found;
  const Index in_folders = folder_index();
  found = described(in_folders, [&](const Named& thing) {
    return thing.name == name || (thing.kind == "claim" && lower_case(thing.name) == lower_case(name));
  });
  if (!found.empty()) return found;
  std::error_code ignored;
  if (!std::filesystem::exists(name, ignored)) refuse(name, index, in_folders);
  return {describe_scenario(find_scenario(name))};
}

int describe(const DescribeOptions& options) {
  if (options.name.empty() || is_kind(options.name)) return list(options);
  const Index index = program_index();
  std::vector<Description> meanings = described_by_name(index, options.name);
  if (meanings.empty()) meanings = described_headings(index, options.name);
  const bool is_group = std::ranges::find(kScenarioGroups, options.name) != std::end(kScenarioGroups);
  if (meanings.empty() && is_group) return list(options);
  if (!options.grep.empty()) throw InputError("--grep: allowed: without a name, or with that of a list");
  if (meanings.empty()) meanings = other_meanings(index, options.name);
  const Description d = joined(meanings);
  OutputOptions output = options.output;
  output.json |= d.text.empty();
  print(output, d.text, d.json);
  return kSuccess;
}

}  // namespace

void add_describe(CommandLine& line) {
  auto [command, options] = line.command("describe", "Explain a name; without one, or by a kind: a list", describe);
  command.add(
      "name", options.name,
      "an algorithm, a depth model, an integrator, an environment, a hand, a device, a scenario, a study; a kind of these "
      "such as algorithms, or a group of scenarios such as thesis, for a list; a field such as rendering.limits, "
      "\"scenario\" (all fields), \"schema\", \"choices_schema\", \"stability\", \"diagnosis\"; a metric, \"metrics\" or "
      "\"columns\" for all of them, a heading such as \">30Hz rms N\", or a file such as trajectory.csv; a claim such as C5, a "
      "choice such as planar.first_tilt or a place such as \"Fig. A.2\"");
  command.add("--grep", options.grep, "list only things with this text in their name, description or source");
}

}  // namespace hapbench
