#include "scenarios/program/describe/thesis_locations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <regex>
#include <string_view>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe/folders.hpp"
#include "scenarios/program/describe/lists.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

/// A location in the thesis: "Fig. A.2" has the kind "Fig." and the number "A.2". The kind is "Fig.", "Table", "Eq." or
/// "section"; empty: any kind.
struct ThesisLocation {
  std::string kind, number;
};

/// Returns the kind of the locations whose numbers follow a word: "Fig." for "figure", "Table" for "table", "Eq." for
/// "equation", also for their short forms; "section" for every other word.
std::string location_kind(const std::string& word) {
  const std::string lower = lower_case(word);
  if (lower == "fig" || lower == "figs" || lower == "figure") return "Fig.";
  if (lower == "table" || lower == "tables") return "Table";
  if (lower == "eq" || lower == "eqs" || lower == "equation") return "Eq.";
  return "section";
}

/// Parses the name of a location. If `name` has no kind, the kind of the location is empty. Also accepts the file name
/// of a figure, such as figure_A.4_springs.svg. Returns empty for other names.
std::optional<ThesisLocation> parse_thesis_location(const std::string& name) {
  static const std::regex kLocation(R"((?:(fig|figs|figure|table|section|eq|eqs|equation)[._ ]*)?)"
                                    R"(\(?((?:[a-f]\.? ?)?\d+(?:\.\d+)*[a-d]?)\)?(?:_[a-z_]+)?(?:\.(?:svg|png|pdf))?)",
                                    std::regex::icase);
  std::smatch parts;
  if (!std::regex_match(name, parts, kLocation)) return std::nullopt;
  ThesisLocation location{parts[1].matched ? location_kind(parts[1]) : "", parts[2]};
  // Accept "Fig. F4" and "Table A. 1", as the thesis prints them, for F.4 and A.1.
  if (!location.kind.empty() && std::isalpha(static_cast<unsigned char>(location.number[0]))) {
    std::erase(location.number, ' ');
    if (location.number[1] != '.') location.number.insert(1, ".");
  }
  // Reject a number that has neither a kind nor a dot, because it is ambiguous.
  if (location.kind.empty() && location.number.find('.') == std::string::npos) return std::nullopt;
  if (location.number.find('.') == 1) location.number[0] = static_cast<char>(std::toupper(location.number[0]));
  return location;
}

/// Returns true if a source such as "3.3, Fig. 4, C.2a" names the location or a part of it. A kind applies to all
/// numbers up to the next word. A number that means something else, such as a year, is treated as a location too.
bool mentions_location(const std::string& source, const ThesisLocation& requested) {
  static const std::regex kParts(R"(([A-F]\.\d+|\d+)(\.\d+)*[a-d]?\b|[A-Za-z]+)");
  std::string kind = "section";
  for (std::sregex_iterator found(source.begin(), source.end(), kParts), end; found != end; ++found) {
    const std::string word = found->str();
    if (!(*found)[1].matched) {
      if (word != "and") kind = location_kind(word);
      continue;
    }
    if ((!requested.kind.empty() && kind != requested.kind) || !word.starts_with(requested.number)) continue;
    const std::string part = word.substr(requested.number.size());
    if (part.empty() || part[0] == '.' || std::isalpha(static_cast<unsigned char>(part[0]))) return true;
  }
  return false;
}

/// Returns the contents of the thesis at the location, as entries of thesis_places.json, which also name the matching
/// part of hapbench. Returns all entries with this name, because two tables of the thesis have the same number.
Json contents_of(const ThesisLocation& location) {
  const std::filesystem::path file = installed_folder("results/reference") / "thesis_places.json";
  const std::string number = location.number.substr(0, location.number.find_last_not_of("abcd") + 1);
  Json contents = Json::array();
  for (const Json& entry : with_file(file, [&] { return read_json(file).at("places"); })) {
    const std::string name = entry.at("place").get<std::string>();
    if (location.kind.empty() ? name.ends_with(" " + number) : name == location.kind + " " + number)
      contents.push_back(entry);
  }
  return contents;
}

/// Returns the stored pictures of a figure of the thesis: figure_A.2.svg for "A.2".
std::vector<std::filesystem::path> pictures_of(const ThesisLocation& location) {
  if (!location.kind.empty() && location.kind != "Fig.") return {};
  const std::string figure = location.number.substr(0, location.number.find_last_not_of("abcd") + 1);
  std::vector<std::filesystem::path> pictures;
  std::error_code none;
  for (const auto& entry :
       std::filesystem::directory_iterator(installed_folder("results/reference") / "figures", none)) {
    if ((entry.path().stem().string() + "_").starts_with("figure_" + figure + "_")) pictures.push_back(entry.path());
  }
  std::ranges::sort(pictures);
  return pictures;
}

}  // namespace

std::optional<Description> describe_thesis_location(const std::string& name, const Layout& layout) {
  const std::optional<ThesisLocation> location = parse_thesis_location(name);
  if (!location) return std::nullopt;
  const std::string title = location->kind + (location->kind.empty() ? "" : " ") + location->number;
  // Collect scenarios and claims whose source names the location.
  std::string scenarios, claims;
  Json json = {{"kind", "place"}, {"name", title}, {"scenarios", Json::array()}, {"claims", Json::array()}};
  for (const IndexEntry& item : folder_index(layout)) {
    const std::string source = item.more.value("source", "");
    if (!mentions_location(source, *location)) continue;
    if (item.kind == "claim")
      claims += layout.entry(item.name, fmt::format("{} ({})", item.summary, source), 4, 10);
    else
      scenarios += layout.entry(item.name, source, 4, 44);
    json[list_name(item.kind)].push_back(item.name);
  }
  // Collect the stored pictures.
  std::string pictures;
  for (const std::filesystem::path& picture : pictures_of(*location)) {
    std::string id = picture.stem().string().substr(std::string_view("figure_").size());
    std::replace(id.begin(), id.end(), '_', '-');
    pictures += fmt::format("    {}\n    redraw it with: scripts/reproduce --figure {}\n", picture.string(), id);
    json["pictures"].push_back(picture.string());
  }
  // Collect the contents of the thesis at this location.
  std::string contents;
  const Json entries = contents_of(*location);
  for (const Json& entry : entries) {
    const std::string see = entry.value("see", "");
    contents += layout.entry(entry.at("place").get<std::string>(),
                             entry.at("what").get<std::string>() + (see.empty() ? "" : "; here: " + see), 4, 16);
  }
  json["contents"] = entries;
  if (scenarios.empty() && claims.empty() && pictures.empty() && contents.empty())
    throw InputError(fmt::format("no bundled scenario, claim or picture refers to {} of the thesis", title));
  return Description{fmt::format("{} of the thesis\n\n{}{}  scenarios\n{}\n  claims\n{}", bold(stdout, title),
                                 contents.empty() ? "" : "  contents\n" + contents + "\n",
                                 pictures.empty() ? "" : "  picture\n" + pictures + "\n",
                                 scenarios.empty() ? "    none\n" : scenarios, claims.empty() ? "    none\n" : claims),
                     json};
}

}  // namespace hapbench
