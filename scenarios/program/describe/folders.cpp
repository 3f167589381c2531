#include "scenarios/program/describe/folders.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

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

/// Returns the entry of a claim or assumption of the reference results. `titled` renames and removes members for the
/// printed text of the entry.
IndexEntry on_record(const char* kind, const Json& item, const std::string& summary,
                     const std::function<Json(Json)>& titled, const Layout& layout) {
  const auto describe = [=] {
    Json named = {{"kind", fmt::format("{}, as recorded in results/reference", kind)}, {"name", item.at("id")}};
    named.update(item);
    named.erase("id");
    return Description{entry_text(titled(named), layout), item};
  };
  return {kind, item.at("id").get<std::string>(), summary, describe};
}

/// Returns, as texts, the cases in a claim's sensitivity record whose verdict differs from the recorded verdict.
std::vector<std::string> moved_cases(const Json& claim) {
  std::vector<std::string> texts;
  for (const Json& one : claim.at("cases_moved")) {
    const auto text = [&one](const char* key) { return one.at(key).get<std::string>(); };
    texts.push_back(fmt::format("{} = {}: {}{}{}", text("assumption"), text("value"), text("verdict"),
                                text("number").empty() ? "" : ", ", text("number")));
  }
  return texts;
}

IndexEntry recorded_claim(const Json& claim, const Layout& layout) {
  const auto titled = [](Json named) {
    const auto tried = named.at("cases_tried").get<std::size_t>();
    if (tried > 0) {
      const std::vector<std::string> moved = moved_cases(named);
      named["sensitivity"] =
          fmt::format("{} other values of assumptions tried; {}", tried,
                      moved.empty() ? "none changes the verdict" : fmt::format("{}", fmt::join(moved, "; ")));
    }
    if (named.contains("revised")) {
      const Json before = named.at("revised");
      named["earlier rule"] = before.at("rule");
      named["its verdict"] =
          fmt::format("{}; {}", before.at("verdict").get<std::string>(), before.at("robustness").get<std::string>());
      named["why changed"] = before.at("reason");
    }
    // Rename the member "measured" to "cases", and omit members that only programs need.
    named["cases"] = named.at("measured");
    for (const char* member : {"measured", "ours", "timing", "added", "deciders", "cases_tried", "cases_moved",
                               "revised", "published_short"})
      named.erase(member);
    return named;
  };
  IndexEntry entry = on_record("claim", claim, claim.at("claim").get<std::string>(), titled, layout);
  entry.more = {{"verdict", claim.at("verdict")}, {"source", claim.at("place")}};
  for (const char* member : {"robustness", "published", "measured"}) entry.more[member] = claim.value(member, "");
  return entry;
}

/// Returns the entry of an assumption, with the claims whose verdict it decides.
IndexEntry recorded_assumption(const Json& assumption, const Json& claims, const Layout& layout) {
  std::string decided;
  for (const Json& claim : claims) {
    const auto deciders = claim.at("deciders").get<std::vector<std::string>>();
    if (std::ranges::find(deciders, assumption.at("id").get<std::string>()) == deciders.end()) continue;
    decided += (decided.empty() ? "" : ", ") + claim.at("id").get<std::string>();
  }
  const auto titled = [decided](Json named) {
    named["chosen"] = fmt::format("{} the results were known", named.at("chosen").get<std::string>());
    named["decides"] = decided.empty() ? "no verdict" : decided;
    return named;
  };
  return on_record("assumption", assumption, assumption.at("what").get<std::string>(), titled, layout);
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
  const Json claims = list_on_record("claims");
  for (const Json& claim : claims) index.push_back(recorded_claim(claim, layout));
  for (const Json& assumption : list_on_record("assumptions"))
    index.push_back(recorded_assumption(assumption, claims, layout));
  std::ranges::move(glossary_index(layout), std::back_inserter(index));
  return index;
}

}  // namespace hapbench
