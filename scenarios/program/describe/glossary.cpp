#include "scenarios/program/describe/glossary.hpp"

#include <algorithm>
#include <string>

#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

constexpr const char* kTerm = "term";

/// Returns the name in lower case, without spaces at its ends and with a space in place of each "_".
std::string normalized(std::string_view name) {
  std::string normal = lower_case(trimmed(name));
  std::ranges::replace(normal, '_', ' ');
  return normal;
}

/// Returns true if `name` is the whole title of an entry, or one of the names that commas separate in the title,
/// without the text in parentheses after this name.
bool is_name_of(std::string_view title, std::string_view name) {
  const std::string wanted = normalized(name);
  if (normalized(title) == wanted) return true;
  return std::ranges::any_of(parts_of(title, ','), [&](std::string_view alias) {
    return normalized(alias.substr(0, alias.find('('))) == wanted;
  });
}

}  // namespace

Index glossary_index(const Layout& layout) {
  const std::string text = read_text_file(installed_folder("scenarios") / "GLOSSARY.md", kMaxJsonFileBytes);
  Index index;
  // Each entry is a row "| term | meaning |" of the table. The first two rows of the table are its heading and
  // the rule below it.
  bool is_in_table = false;
  for (const std::string_view line : parts_of(text, '\n')) {
    if (line.starts_with("|---")) {
      is_in_table = true;
      continue;
    }
    const Words cells = parts_of(line, '|');
    if (!is_in_table || cells.size() != 4) continue;
    const Json json = {{"kind", kTerm}, {"name", trimmed(cells[1])}, {"meaning", trimmed(cells[2])}};
    index.push_back({kTerm, json["name"].get<std::string>(), json["meaning"].get<std::string>(),
                     [json, layout] { return entry_description(json, layout); }});
  }
  return index;
}

std::optional<Description> find_term(const Index& index, std::string_view name) {
  std::vector<Description> found;
  for (const IndexEntry& entry : index)
    if (entry.kind == kTerm && is_name_of(entry.name, name)) found.push_back(entry.describe());
  if (found.empty()) return std::nullopt;
  return joined(found);
}

}  // namespace hapbench
