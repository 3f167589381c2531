#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "device_model/device_presets.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/describe_thesis.hpp"
#include "scenarios/program/schema_text.hpp"
#include "scenarios/program/table.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// A thing that has a name.
struct Listed {
  std::string kind;  ///< "algorithm", …
  std::string name;
  std::string summary;
  std::string group = {};    ///< of a scenario
  std::string source = {};   ///< of a scenario or a claim: where in the thesis it is, or its numbers come from
  std::string verdict = {};  ///< of a claim
};

void add_models(std::vector<Listed>& all, const char* kind, const ModelInfo& info) {
  all.push_back({kind, info.name, info.summary});
}

Listed listed_scenario(const BundledScenario& bundled) {
  try {
    const Scenario scenario = load_scenario(bundled.file).scenario;
    return {"scenario", bundled.name, scenario.description, bundled.group, scenario.source};
  } catch (const InputError& error) {
    return {"scenario", bundled.name, error.what(), bundled.group};
  }
}

std::vector<Listed> everything() {
  std::vector<Listed> all;
  for (const AlgorithmEntry& entry : algorithms()) add_models(all, "algorithm", *entry.info);
  for (const DepthModelEntry& entry : depth_models()) add_models(all, "depth model", *entry.info);
  for (const ModelInfo* stage : stages()) add_models(all, "stage", *stage);
  for (const IntegratorEntry* entry : kIntegrators) add_models(all, "integrator", entry->info);
  for (const char* field : {"environment", "tool", "hand", "device"}) {
    for (const std::string& type : type_names(field)) all.push_back({field, type, type_summary(type, field)});
  }
  for (const DevicePreset& preset : device_presets()) all.push_back({"preset", preset.name, preset.device});
  for (const BundledScenario& bundled : bundled_scenarios()) all.push_back(listed_scenario(bundled));
  for (const auto& [name, unit, meaning, value] : metrics_without_values()) all.push_back({"metric", name, meaning});
  for (const Json& claim : claims_on_record())
    all.push_back({"claim", claim.at("id"), claim.at("claim"), "", claim.at("place"), claim.at("verdict")});
  return all;
}

/// What can be asked for: kinds, and groups of scenarios.
std::vector<std::string> sections_of(const std::vector<Listed>& all) {
  std::vector<std::string> names;
  for (const Listed& thing : all) {
    for (const std::string& name : {thing.kind, thing.group}) {
      if (!name.empty() && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

constexpr std::size_t kColumn = 34;  // of the summaries

/// What a thing is: the first sentence, up to a semicolon or a colon that is not near its beginning; and no more than
/// the line holds.
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

/// The name without the algorithm at its end: what scenarios of one scene have in common.
std::string scene_of(const std::string& name) {
  std::size_t longest = 0;
  for (const AlgorithmEntry& entry : algorithms()) {
    const std::string end = std::string("_") + entry.info->name;
    if (name.ends_with(end)) longest = std::max(longest, end.size());
  }
  return name.substr(0, name.size() - longest);
}

/// Those that are one scene under several algorithms stand together, where the first of them would.
std::string entry_of(const std::vector<Listed>& all, const Listed& first) {
  if (!first.verdict.empty())
    return entry(fmt::format("{:<5}{}", first.name, first.verdict), first.summary, 2, kColumn, output_width());
  const std::string scene = scene_of(first.name);
  std::vector<std::string> algorithms;
  for (const Listed& thing : all) {
    if (thing.kind == "scenario" && thing.group == first.group && thing.name != scene && scene_of(thing.name) == scene)
      algorithms.push_back(thing.name.substr(scene.size() + 1));
  }
  if (first.kind != "scenario" || first.name == scene || algorithms.size() < 2)
    return entry(first.name, short_summary(first.summary), 2, kColumn, output_width());
  if (!first.name.ends_with("_" + algorithms.front())) return "";  // stands there already
  return entry(scene + "_*", short_summary(first.summary), 2, kColumn, output_width()) +
         wrapped(fmt::format("*: {}", fmt::join(algorithms, ", ")), kColumn);
}

std::string list_text(const std::vector<Listed>& all) {
  std::string text, title;
  for (const Listed& thing : all) {
    const std::string of = thing.group.empty() ? thing.kind + "s" : "scenarios: " + thing.group;
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
  std::vector<Listed> all = everything();
  if (!options.what.empty()) {
    // "scenarios" and "depth_models" are as good as "scenario" and "depth model".
    std::string what = options.what;
    std::replace(what.begin(), what.end(), '_', ' ');
    const std::vector<std::string> sections = sections_of(all);
    for (const std::string& section : sections) {
      if (what == section + "s") what = section;
    }
    require_valid_name("got", what, sections);
    std::erase_if(all, [&what](const Listed& thing) { return thing.kind != what && thing.group != what; });
  }
  // Of these there are so many that they are shown to those who ask.
  const bool of_everything = options.what.empty() && options.grep.empty();
  if (of_everything)
    std::erase_if(all, [](const Listed& thing) { return thing.kind == "metric" || thing.kind == "claim"; });
  const std::string pattern = lower_case(options.grep);
  std::erase_if(all, [&pattern](const Listed& thing) {
    return lower_case(thing.name + " " + thing.summary + " " + thing.source).find(pattern) == std::string::npos;
  });
  if (all.empty()) throw InputError(fmt::format("--grep: nothing has \"{}\" in its name or text", options.grep));
  Json json = Json::array();
  for (const Listed& thing : all) {
    Json& entry = json.emplace_back(Json{{"kind", thing.kind}, {"name", thing.name}, {"summary", thing.summary}});
    if (!thing.group.empty()) entry.update({{"group", thing.group}, {"source", thing.source}});
    if (!thing.verdict.empty()) entry.update({{"verdict", thing.verdict}, {"source", thing.source}});
  }
  print(options.output,
        list_text(all) + (of_everything ? "\"hapbench list metrics\" and \"list claims\" show more.\n" : ""), json);
  return kSuccess;
}

}  // namespace

void add_list(CommandLine& line) {
  auto options = std::make_shared<ListOptions>();
  Command command =
      line.command("list", "List algorithms, models, integrators, environments, hands, scenarios, metrics and claims");
  command.add(
      "what", options->what,
      "one kind alone: algorithms, depth_models, stages, integrators, environments, hands, devices, scenarios, or "
      "a group of those: thesis, limits, beyond, quality, examples; or metrics, or claims");
  command.add("--grep", options->grep, "only what has this text in its name, its description or its source");
  add_output_options(command, options->output);
  command.runs([options] { return list(*options); });
}

}  // namespace hapbench
