#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "device_model/device_presets.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/describe.hpp"
#include "scenarios/program/fields_text.hpp"
#include "scenarios/program/study.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/thesis_claims/ledger.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

/// A thing that has a name.
struct Listed {
  std::string kind;  ///< such as "algorithm"
  std::string name;
  std::string summary;
  std::string group = {};   ///< of a scenario
  std::string source = {};  ///< of a scenario or a claim: its place in the thesis, or the source of its numbers
  Json claim = {};          ///< as in the ledger
};

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
  const auto add = [&all](const char* kind, const ModelInfo& info) { all.push_back({kind, info.name, info.summary}); };
  for (const AlgorithmEntry& entry : algorithms()) add("algorithm", *entry.info);
  for (const DepthModelEntry& entry : depth_models()) add("depth model", *entry.info);
  for (const ModelInfo* stage : stages()) add("stage", *stage);
  for (const IntegratorEntry* entry : kIntegrators) add("integrator", entry->info);
  for (const char* field : {"environment", "tool", "hand", "device"}) {
    for (const ValueGuide& type : types_of(field)) all.push_back({field, type.type, type.summary});
  }
  for (const DevicePreset& preset : device_presets()) all.push_back({"preset", preset.name, preset.device});
  for (const BundledScenario& bundled : bundled_scenarios()) all.push_back(listed_scenario(bundled));
  for (const BundledStudy& study : bundled_studies()) all.push_back({"study", study.name, study.summary});
  for (const Metric& metric : metrics_without_values()) all.push_back({"metric", metric.name, metric.meaning});
  for (const Json& claim : claims_on_record()) {
    all.push_back({.kind = "claim",
                   .name = claim.at("id"),
                   .summary = claim.at("claim"),
                   .group = "",
                   .source = claim.at("place"),
                   .claim = claim});
  }
  return all;
}

std::string plural(const std::string& kind) {
  return kind == "study" ? "studies" : kind + "s";
}

/// The kinds, and the groups of scenarios.
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
std::string entry_of(const std::vector<Listed>& all, const Listed& first) {
  if (!first.claim.is_null())
    return entry(fmt::format("{:<5}{}", first.name, verdicts_text(first.claim)), first.summary, 2, kColumn,
                 output_width());
  const std::string scene = scene_of(first.name);
  std::vector<std::string> algorithms;
  for (const Listed& thing : all) {
    if (thing.kind == "scenario" && thing.group == first.group && thing.name != scene && scene_of(thing.name) == scene)
      algorithms.push_back(thing.name.substr(scene.size() + 1));
  }
  if (first.kind != "scenario" || first.name == scene || algorithms.size() < 2)
    return entry(first.name, short_summary(first.summary), 2, kColumn, output_width());
  if (!first.name.ends_with("_" + algorithms.front())) return "";  // on the line of the first
  return entry(scene + "_*", short_summary(first.summary), 2, kColumn, output_width()) +
         wrapped(fmt::format("*: {}", fmt::join(algorithms, ", ")), kColumn);
}

std::string list_text(const std::vector<Listed>& all) {
  std::string text, title;
  for (const Listed& thing : all) {
    const std::string of = thing.group.empty() ? plural(thing.kind) : "scenarios: " + thing.group;
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
    // "scenario" and "depth model" are accepted like "scenarios" and "depth_models".
    std::string what = options.what;
    std::replace(what.begin(), what.end(), '_', ' ');
    const std::vector<std::string> sections = sections_of(all);
    for (const std::string& section : sections) {
      if (what == plural(section)) what = section;
    }
    require_valid_name("got", what, sections);
    std::erase_if(all, [&what](const Listed& thing) { return thing.kind != what && thing.group != what; });
  }
  // There are so many metrics and claims that they are only shown on request.
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
    if (!thing.claim.is_null()) {
      entry.update(
          {{"verdict", thing.claim.at("verdict")}, {"majority", thing.claim.at("majority")}, {"source", thing.source}});
    }
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
