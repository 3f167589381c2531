#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

#include "algorithms/registry.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/descriptions.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

void add_models(Table& table, Json& json, const char* kind, const ModelInfo& info) {
  table.add({kind, info.name, info.summary});
  json.push_back({{"kind", kind}, {"name", info.name}, {"summary", info.summary}});
}

int list(const OutputOptions& options) {
  Table table({{"kind", false}, {"name", false}, {"what it is", false}});
  Json json = Json::array();
  for (const AlgorithmEntry& entry : algorithms()) add_models(table, json, "algorithm", *entry.info);
  for (const DepthModelEntry& entry : depth_models()) add_models(table, json, "depth model", *entry.info);
  for (const ModelInfo* stage : stages()) add_models(table, json, "stage", *stage);
  for (const IntegratorEntry* entry : kIntegrators) add_models(table, json, "integrator", entry->info);
  for (const std::string& name : environment_names()) {
    table.add({"environment", name, ""});
    json.push_back({{"kind", "environment"}, {"name", name}});
  }
  for (const BundledScenario& bundled : bundled_scenarios()) {
    std::string description;
    try {
      description = load_scenario(bundled.file).scenario.source;
    } catch (const InputError& error) {
      description = error.what();
    }
    table.add({"scenario/" + bundled.group, bundled.name, description});
    json.push_back({{"kind", "scenario"}, {"group", bundled.group}, {"name", bundled.name}, {"source", description}});
  }
  print(options, table.text(), json);
  return kSuccess;
}

}  // namespace

void add_list(CommandLine& line) {
  auto options = std::make_shared<OutputOptions>();
  Command command =
      line.command("list", "List algorithms, depth models, integrators, environments and bundled scenarios");
  add_output_options(command, *options);
  command.runs([options] { return list(*options); });
}

}  // namespace hapbench
