#include "scenarios/program/describe/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe/folders.hpp"
#include "scenarios/program/describe/glossary.hpp"
#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/describe/lists.hpp"
#include "scenarios/program/describe/result_names.hpp"
#include "scenarios/program/describe/thesis_locations.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/output.hpp"

namespace hapbench {
namespace {

/// Returns the text in lower case without white space.
std::string plain(std::string_view text) {
  std::string plain = lower_case(text);
  std::erase_if(plain, [](unsigned char c) { return std::isspace(c); });
  return plain;
}

/// Returns true if `name` is the entry's heading, such as "mean force [N]", the heading without its unit, "mean force",
/// or the first line of the heading, "mean". Ignores case and spaces.
bool is_heading(const IndexEntry& item, std::string_view name) {
  const std::string_view title = item.name;
  return item.kind == "heading" &&
         (plain(name) == plain(title) || plain(name) == plain(title.substr(0, title.find(" ["))) ||
          plain(name) == plain(title.substr(0, title.find('\n'))));
}

std::vector<Description> described(const Index& index, const std::function<bool(const IndexEntry&)>& is_meant) {
  std::vector<Description> found;
  for (const IndexEntry& item : index)
    if (is_meant(item)) found.push_back(item.describe());
  return found;
}

std::vector<Description> described_by_name(const Index& index, std::string_view name) {
  return described(index, [name](const IndexEntry& item) {
    return item.kind != "heading" && item.kind != kJsonKey && item.name == name;
  });
}

/// Returns the meanings of the headings with this name, each meaning once.
std::vector<Description> described_headings(const Index& index, const std::string& name) {
  std::vector<Description> found;
  for (const IndexEntry& heading : index) {
    if (!is_heading(heading, name)) continue;
    std::vector<Description> meanings = described_by_name(index, heading.summary);
    // A table can have a column with the name of a metric; its meaning refers to the metric.
    const auto is_metric = [](const Description& meaning) { return meaning.json.value("kind", "") == "metric"; };
    if (std::ranges::any_of(meanings, is_metric)) std::erase_if(meanings, std::not_fn(is_metric));
    if (meanings.empty()) meanings.push_back(heading.describe());
    for (Description& meaning : meanings)
      if (std::ranges::find(found, meaning.text, &Description::text) == found.end())
        found.push_back(std::move(meaning));
  }
  return found;
}

[[noreturn]] void refuse(const std::string& name, const Index& index, const Index& in_folders) {
  std::vector<std::string> names = names_of(listed_kinds(), list_name);
  for (const Index* known : {&index, &in_folders})
    for (const IndexEntry& item : *known)
      if (item.kind != "heading") names.push_back(item.name);
  throw InputError(
      fmt::format("nothing is called \"{}\"{}; \"hapbench describe\" shows the names, \"hapbench describe scenario\" "
                  "the fields of a scenario file, --grep searches",
                  name, nearest_name_hint(name, names)));
}

/// Returns the meanings of a name that is not in `index`, the index of the program. Throws InputError if the name has
/// no meaning.
std::vector<Description> other_meanings(const Index& index, const std::string& name, const Layout& layout) {
  if (const std::optional<Description> location = describe_thesis_location(name, layout)) return {*location};
  // Find fields with this name in any object ("torque" finds record.torque), and keys that only the JSON has.
  std::vector<Description> found = described(index, [&](const IndexEntry& item) {
    return item.kind == "field" ? item.name.ends_with("." + name) : item.kind == kJsonKey && item.name == name;
  });
  if (!found.empty()) return found;
  // Find scenarios, studies, claims and assumptions of this name.
  const Index in_folders = folder_index(layout);
  found = described(in_folders, [&](const IndexEntry& item) {
    return item.name == name || (item.kind == "claim" && lower_case(item.name) == lower_case(name));
  });
  if (!found.empty()) return found;
  // Find a term of the glossary, then a scenario file.
  if (const std::optional<Description> term = find_term(in_folders, name)) return {*term};
  std::error_code error;
  if (!std::filesystem::exists(name, error) && !error) refuse(name, index, in_folders);
  return {describe_scenario(find_scenario(name), layout)};
}

/// Returns an empty line and the glossary's entry for a name that the program also defines. Returns an empty text if
/// the glossary has no entry, or if the file of the glossary is missing, because the program's meaning does not need
/// this file.
std::string glossary_addition(const std::string& name, const Layout& layout) {
  try {
    const std::optional<Description> term = find_term(glossary_index(layout), name);
    return term ? "\n" + term->text : "";
  } catch (const InputError&) {
    return "";
  }
}

int describe(const DescribeOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  if (options.name.empty() || is_kind(options.name)) return list(options, context);
  // Find the name in the program, as an entry and then as a heading.
  const Index index = program_index(layout);
  std::vector<Description> meanings = described_by_name(index, options.name);
  if (meanings.empty()) meanings = described_headings(index, options.name);
  const bool is_group = std::ranges::find(kScenarioGroups, options.name) != std::end(kScenarioGroups);
  if (meanings.empty() && is_group) return list(options, context);
  if (!options.output.table.empty())
    fail_in_option(
        "--table",
        fmt::format("got the name \"{}\"; allowed: the name of a list, such as claims or algorithms", options.name));
  if (!options.grep.empty()) throw InputError("--grep: allowed: no name, or the name of a list");
  const bool is_known = !meanings.empty();
  if (!is_known) meanings = other_meanings(index, options.name, layout);
  Description d = joined(meanings);
  // A name of the program may also be a term of the glossary, such as "proxy". The text has both meanings, the
  // JSON only the program's meaning.
  if (is_known && !d.text.empty()) d.text += glossary_addition(options.name, layout);
  OutputOptions output = options.output;
  output.json |= d.text.empty();
  print(context, output, d.text, d.json);
  return kSuccess;
}

}  // namespace

void add_describe(CommandLine& line) {
  auto [command, options] = line.command("describe", "Explain a name, or list what exists.", describe);
  command.add(
      "name <name>", options.name,
      "what to explain, see below; without it, all names are listed except metrics, claims, assumptions and terms, "
      "which have lists of their own");
  command.add("--grep <text>", options.grep,
              "list only entries with this text in name, description or source: of the list <name>, or of all lists");
  add_table(command, options.output);
  command.footer(
      "A list: algorithms, scenarios, studies, devices (types), presets (parameters of real devices), metrics, "
      "columns, claims, assumptions, terms, or a group of scenarios such as thesis.\n\n"
      "Scenario files: \"scenario\" (all fields), a field such as rendering.limits (unit, allowed values, default), "
      "or \"schema\".\n\n"
      "Results: a file such as trajectory.csv (all its columns with units), a column, a metric, a key of summary.json "
      "or timing.json, an outcome such as went_through, or the heading of a table such as \"mean force\".\n\n"
      "Concepts: \"stability\", \"diagnosis\", or a term of the glossary such as \"linear limit\".\n\n"
      "Models: the name of a force law, depth model, integrator, environment, hand, device, scenario or study.\n\n"
      "Thesis: a claim such as C5, an assumption such as planar.first_tilt, a figure, table or equation such as \"Fig. "
      "A.2\", or \"assumptions_schema\".\n\n"
      "The program: the name of a command, such as tune.\n\n"
      "Unknown name: exit status 2, and a message with the nearest valid name, if a similar name exists.");
}

}  // namespace hapbench
