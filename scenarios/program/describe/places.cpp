#include "scenarios/program/describe/places.hpp"

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

namespace hapbench {
namespace {

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
  static const std::regex kPlace(R"((?:(fig|figs|figure|table|section)[._ ]*)?)"
                                 R"(((?:[a-f]\.)?\d+(?:\.\d+)*[a-d]?)(?:_[a-z_]+)?(?:\.(?:svg|png|pdf))?)",
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

}  // namespace

std::optional<Description> describe_place(const std::string& name, const Layout& layout) {
  const std::optional<Place> place = asked_place(name);
  if (!place) return std::nullopt;
  const std::string title = place->kind + (place->kind.empty() ? "" : " ") + place->number;
  std::string scenarios, claims;
  Json json = {{"kind", "place"}, {"name", title}, {"scenarios", Json::array()}, {"claims", Json::array()}};
  for (const Named& thing : folder_index(layout)) {
    const std::string source = thing.more.value("source", "");
    if (!names_place(source, *place)) continue;
    if (thing.kind == "claim")
      claims += layout.entry(thing.name, fmt::format("{} ({})", thing.summary, source), 4, 10);
    else
      scenarios += layout.entry(thing.name, source, 4, 44);
    json[list_name(thing.kind)].push_back(thing.name);
  }
  std::string pictures;
  for (const std::filesystem::path& picture : pictures_of(*place)) {
    std::string id = picture.stem().string().substr(std::string_view("figure_").size());
    std::replace(id.begin(), id.end(), '_', '-');
    pictures += fmt::format("    {}\n    redraw it with: scripts/reproduce --figure {}\n", picture.string(), id);
    json["pictures"].push_back(picture.string());
  }
  if (scenarios.empty() && claims.empty() && pictures.empty())
    throw InputError(fmt::format("no bundled scenario and no claim refers to {} of the thesis", title));
  return Description{fmt::format("{} of the thesis\n\n{}  scenarios\n{}\n  claims\n{}", bold(stdout, title),
                                 pictures.empty() ? "" : "  picture\n" + pictures + "\n",
                                 scenarios.empty() ? "    none\n" : scenarios, claims.empty() ? "    none\n" : claims),
                     json};
}

}  // namespace hapbench
