#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/thesis_claims/ledger.hpp"

namespace hapbench {
namespace {

/// The kinds that lists have, in their order.
constexpr const char* kListed[] = {"algorithm", "depth model", "stage",    "integrator", "environment", "tool", "hand",
                                   "device",    "preset",      "scenario", "study",      "metric",      "claim"};

Index everything() {
  Index index = program_index(), all;
  std::ranges::move(folder_index(), std::back_inserter(index));
  for (const std::string_view kind : kListed) {
    for (Named& thing : index) {
      if (thing.kind != kind) continue;
      if (thing.read) thing.read(thing);
      all.push_back(std::move(thing));
    }
  }
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
    return entry(fmt::format("{:<5}{}", first.name, verdicts_text(first.more)), first.summary, 2, kColumn,
                 output_width());
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
  add_output_options(command, options.output);
}

}  // namespace hapbench
