#include "scenarios/program/describe/description.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <string_view>

#include "scenarios/program/text.hpp"

namespace hapbench {
namespace {

/// Returns a value in one line. The entries of a list and the members of an object are separated by commas, and
/// members follow their keys.
std::string line_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_structured()) return value.is_null() ? "" : value.dump();
  std::string line;
  for (const auto& [key, part] : value.items())
    line += (line.empty() ? "" : ", ") + (value.is_object() ? key + " " : "") + line_of(part);
  return line;
}

/// Keys of members that describe an entry in a sentence.
constexpr std::string_view kProse[] = {"summary", "meaning", "holds", "claim", "what"};

/// Returns the texts of an array of entries.
std::string entries_text(const Json& items, const Layout& layout, std::size_t indent) {
  std::string text;
  for (const Json& item : items) text += entry_text(item, layout, indent);
  return text;
}

}  // namespace

Description joined(const std::vector<Description>& meanings) {
  if (meanings.size() == 1) return meanings.front();
  Description all{"", Json::array()};
  for (const Description& meaning : meanings) {
    all.text += (all.text.empty() ? "" : "\n") + meaning.text;
    // If a meaning is itself an array of meanings, add each of them.
    const Json list = meaning.json.is_array() ? meaning.json : Json::array({meaning.json});
    all.json.insert(all.json.end(), list.begin(), list.end());
  }
  return all;
}

std::string entry_text(const Json& item, const Layout& layout, std::size_t indent) {
  std::string name = item.value("name", "");
  std::replace(name.begin(), name.end(), '\n', ' ');
  const std::string kind = item.value("kind", ""), unit = item.value("unit", "");
  // Divide the members into prose, values of one line, and lists of entries.
  std::string prose, facts, lists;
  for (const auto& [key, value] : item.items()) {
    if (key == "kind" || key == "name" || key == "unit") continue;
    std::string title = key;
    std::replace(title.begin(), title.end(), '_', ' ');
    const bool is_list = value.is_array() && !value.empty() && value.front().is_object();
    const std::string line = is_list ? "" : line_of(value);
    if (is_list) {
      lists += fmt::format("\n{:{}}{}\n{}", "", indent + 2, title, entries_text(value, layout, indent + 4));
    } else if (line.empty()) {
      continue;
    } else if (std::ranges::find(kProse, key) != std::end(kProse)) {
      prose += layout.wrapped(line, indent + 2);
    } else {
      facts += layout.entry(title, line, indent + 2, indent + 17);
    }
  }
  std::string text;
  // Write the first line with name, unit and kind.
  if (!name.empty()) {
    if (!unit.empty()) name += fmt::format(" [{}]", unit);
    text = fmt::format("{:{}}{}{}{}\n", "", indent, bold(stdout, name), kind.empty() ? "" : ": ", kind);
  }
  return text + prose + (facts.empty() || indent > 0 ? "" : "\n") + facts + lists;
}

Description entry_description(const Json& item, const Layout& layout) {
  return {entry_text(item, layout), item};
}

}  // namespace hapbench
