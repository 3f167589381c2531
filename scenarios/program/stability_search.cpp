#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/stability.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/studies/worst_motion/adversary.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::vector<LoadedScenario> scenes_of(const StabilityOptions& options) {
  if (options.scenarios.size() != 1) {
    throw InputError(
        fmt::format("--search: got {} scenarios; allowed: one, whose scene is searched", options.scenarios.size()));
  }
  const fs::path file = find_scenario(options.scenarios.front());
  std::vector<LoadedScenario> scenes;
  if (options.algorithms.empty()) scenes.push_back(load_scenario(file, options.overrides));
  for (const std::string& algorithm : options.algorithms) {
    std::vector<std::string> overrides = options.overrides;
    overrides.push_back("rendering.algorithm=" + algorithm);
    scenes.push_back(load_scenario(file, overrides));
  }
  for (const LoadedScenario& scene : scenes) with_file(scene, [&] { check_search_scene(scene.scenario); });
  return scenes;
}

SearchOptions search_options(const StabilityOptions& options, const std::string& label) {
  SearchOptions search;
  search.badness = options.objective == "created" ? Badness::created : Badness::vibration;
  search.seed = options.seed;
  search.evaluations = options.evaluations;
  search.jobs = options.job_options(label);
  return search;
}

/// Names the found scenario and says where it comes from.
void describe(const StabilityOptions& options, const std::string& name, const SearchResult& found, Scenario& scenario) {
  const std::string scene = scenario.name;
  scenario.name = name;
  scenario.source = "hapbench stability --search";
  scenario.description = fmt::format(
      "The worst motion of the hand found for {} in {}: objective {} {}, against {} of the tool at rest (seed {}, {} "
      "evaluations, then minimised).",
      scenario.rendering.algorithm, scene, options.objective, significant(found.badness), significant(found.at_rest),
      options.seed, options.evaluations);
}

Json found_json(const std::string& algorithm, const StabilityOptions& options, const SearchResult& found,
                const fs::path& file) {
  return {{"algorithm", algorithm},
          {"objective", options.objective},
          {"at_rest", found.at_rest},
          {"found", found.found},
          {"minimised", found.badness},
          {"waypoints", found.trajectory.size()},
          {"duration_s", found.trajectory.back().time},
          {"outcome", outcome_name(found.run.result.outcome)},
          {"evaluations", found.evaluations},
          {"scenario", file.string()}};
}

}  // namespace

int stability_search_command(const StabilityOptions& options) {
  const std::vector<LoadedScenario> scenes = scenes_of(options);
  const fs::path out = options.directory("stability_search");
  require_writable_directory(out);

  Table table({{"algorithm", false},
               {"at rest"},
               {"found"},
               {"minimised"},
               {"waypoints"},
               {"duration s"},
               {"outcome", false},
               {"runs"},
               {"scenario", false}});
  Json json = Json::array();
  for (const LoadedScenario& scene : scenes) {
    const std::string& algorithm = scene.scenario.rendering.algorithm;
    SearchResult found =
        with_file(scene, [&] { return search_adversary(scene.scenario, search_options(options, algorithm)); });
    const std::string name = fmt::format("worst_{}_{}", options.objective, algorithm);
    const fs::path file = out / (name + ".json");
    describe(options, name, found, found.scenario);
    write_file_atomically(file, json_text(effective_scenario(found.scenario, out)));
    table.add({algorithm, significant(found.at_rest), significant(found.found), significant(found.badness),
               std::to_string(found.trajectory.size()), significant(found.trajectory.back().time),
               std::string(outcome_name(found.run.result.outcome)), std::to_string(found.evaluations), file.string()});
    json.push_back(found_json(algorithm, options, found, file));
  }
  print(options.output, table.text(), json);
  return kSuccess;
}

}  // namespace hapbench
