#include "scenarios/program/describe/folders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <string>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/installed_folder.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/describe/glossary.hpp"
#include "scenarios/program/studies.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

/// Appends a line "time.steps=2000" for each value in a scenario's text.
void add_assignments(std::string& text, const std::string& path, const Json& value, const Layout& layout) {
  if (!value.is_object()) {
    text += layout.wrapped(fmt::format("{}={}", path, shown(value)), 6).erase(4, 2);
    return;
  }
  for (const auto& field : value.items()) {
    if (field.key() == "$schema" || field.key() == "description" || field.key() == "source") continue;
    add_assignments(text, path.empty() ? field.key() : path + "." + field.key(), field.value(), layout);
  }
}

/// Returns the entry of a bundled scenario. If the file is invalid, the error is the entry's description.
IndexEntry named_scenario(const BundledScenario& bundled, const Layout& layout) {
  Json json;
  try {
    json = read_scenario_text(bundled.file).json;
  } catch (const InputError& error) {
    json = {{"description", error.what()}};
  }
  return {"scenario",
          bundled.name,
          json.value("description", ""),
          [file = bundled.file, layout] { return describe_scenario(file, layout); },
          {{"group", bundled.group}, {"source", json.value("source", "")}}};
}

Description describe_study(const BundledStudy& study, const Layout& layout) {
  const std::string text = read_text_file(study.file, kMaxJsonFileBytes);
  return {fmt::format("study {}\n{}\n{}\n{}\n  run it with: hapbench {} {}\n", bold(stdout, study.name),
                      layout.wrapped(study.summary), study.file.string(), text, study.ask, study.name),
          {{"kind", "study"}, {"name", study.name}, {"file", study.file.string()}, {"study", parse_json(text)}}};
}

Json list_on_record(const std::string& list) {
  const std::filesystem::path file = installed_folder("results/reference") / (list + ".json");
  return with_file(file, [&] { return read_json(file).at(list); });
}

/// Returns the entry of a claim or choice of the reference results.
IndexEntry on_record(const char* kind, const Json& item, const Layout& layout) {
  const auto describe = [=] {
    Json titled = {{"kind", fmt::format("{}, as recorded in results/reference", kind)}, {"name", item.at("id")}};
    titled.update(item);
    if (const Json& counts = item.value("robustness", Json()); !counts.is_null())
      titled["sureness"] =
          fmt::format("{}: {} of {} tested assumption sets give this verdict", item.at("sureness").get<std::string>(),
                      counts.at("holds").dump(), counts.at("judged").dump());
    // Omit the members that the text gives in another form, and data for programs.
    for (const char* member : {"id", "cases", "choices_reach_it", "ours", "robustness", "timing"}) titled.erase(member);
    return Description{entry_text(titled, layout), item};
  };
  Json more = Json::object();
  if (item.contains("claim")) {
    more = {{"verdict", item.at("verdict")}, {"source", item.at("place")}};
    for (const char* member : {"sureness", "published", "measured"}) more[member] = item.value(member, "");
  }
  return {kind, item.at("id").get<std::string>(), item.value("claim", ""), describe, more};
}

}  // namespace

Description describe_scenario(const std::filesystem::path& file, const Layout& layout) {
  const ScenarioText given = read_scenario_text(file);
  const LoadedScenario loaded = load_scenario(given, {});
  const Scenario& scenario = loaded.scenario;
  std::string text = fmt::format("scenario {}\n", bold(stdout, scenario.name));
  if (!scenario.description.empty()) text += layout.wrapped(scenario.description);
  text += fmt::format("\n  file    {}\n", file.string());  // never wrapped, so that it can be copied
  if (!scenario.source.empty()) text += layout.entry("source", scenario.source, 2, 10);
  text +=
      "\n  fields that the file sets (\"hapbench describe scenario\" explains them, --json prints all fields with "
      "their defaults)\n";
  add_assignments(text, "", given.json, layout);
  return {text, effective_scenario(scenario, scenario.directory)};
}

Index folder_index(const Layout& layout) {
  Index index;
  for (const BundledScenario& bundled : bundled_scenarios()) index.push_back(named_scenario(bundled, layout));
  for (const BundledStudy& study : bundled_studies())
    index.push_back({"study", study.name, study.summary, [study, layout] { return describe_study(study, layout); }});
  for (const Json& claim : list_on_record("claims")) index.push_back(on_record("claim", claim, layout));
  for (const Json& choice : list_on_record("choices")) index.push_back(on_record("choice", choice, layout));
  std::ranges::move(glossary_index(layout), std::back_inserter(index));
  return index;
}

}  // namespace hapbench
