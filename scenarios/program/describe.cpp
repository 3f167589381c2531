#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <iterator>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"

namespace hapbench {
namespace {

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
  const Index in_folders = folder_index();
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
  add_output_options(command, options.output);
}

}  // namespace hapbench
