#include "scenarios/batch/run_batch.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/batch/result_folders.hpp"
#include "scenarios/run/assemble.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Largest seed of a scenario.
constexpr std::int64_t kMostSeed = std::int64_t{1} << 53;
/// Random stream of the start's shift, which keeps it independent of everything else that the scenario's seed
/// determines.
constexpr std::uint64_t kJitterStream = 0x6a697474;
constexpr const char* kSeedDirectory = "seed_";

LoadedScenario load(const BatchPlan& plan, std::size_t scenario, std::size_t algorithm) {
  std::vector<std::string> overrides = plan.definition.overrides;
  overrides.push_back("rendering.algorithm=" + plan.definition.algorithms[algorithm]);
  const FinerScene finer = plan.finer.empty() ? FinerScene{} : plan.finer[scenario];
  overrides.insert(overrides.end(), finer.overrides.begin(), finer.overrides.end());
  LoadedScenario loaded = load_scenario(plan.scenarios[scenario], overrides);
  loaded.scenario.rendering.skips = plan.definition.skips;
  loaded.scenario.time.stride = finer.stride;
  return loaded;
}

bool lies_in_the_plane(const Environment& environment) {
  if (std::holds_alternative<Hole2d>(environment)) return true;
  const auto* springs = std::get_if<SpringsEnvironment>(&environment);
  if (springs == nullptr || (springs->random.count > 0 && !springs->random.planar)) return false;
  return std::all_of(springs->groups.begin(), springs->groups.end(),
                     [](const SpringGroup& group) { return group.direction.z() == 0.0; });
}

void check_seeds_and_jitter(const BatchDefinition& definition, const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  if (scenario.seed > kMostSeed - static_cast<std::int64_t>(definition.seeds - 1)) {
    throw InputError(fmt::format("{}: /seed: got {}; allowed: at most {} with {} seeds", loaded.file.string(),
                                 scenario.seed, kMostSeed - static_cast<std::int64_t>(definition.seeds - 1),
                                 definition.seeds));
  }
  if (definition.jitter != 0.0 && !std::holds_alternative<FreePosition>(scenario.motion.position)) {
    throw InputError(fmt::format(
        "{}: /motion/position: prescribes the tool's place, which --jitter cannot shift; allowed with it: \"free\"",
        loaded.file.string()));
  }
}

std::vector<std::string> names_of(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const fs::path& file : files) {
    names.push_back(file.stem().string());
    if (seen.insert(names.back()).second) continue;
    throw InputError(fmt::format("{}: a second scenario named \"{}\"; allowed: one of each name in a comparison",
                                 file.string(), names.back()));
  }
  return names;
}

bool contains(const std::vector<std::string>& warnings, const std::string& warning) {
  return std::find(warnings.begin(), warnings.end(), warning) != warnings.end();
}

/// Appends the warnings that are not in the list yet.
void add(std::vector<std::string>& warnings, std::vector<std::string> more) {
  for (std::string& warning : more)
    if (!contains(warnings, warning)) warnings.push_back(std::move(warning));
}

RunReport run_one(const BatchPlan& plan, const BatchOptions& options, std::size_t number) {
  const LoadedScenario loaded = scenario_of(plan, number);
  RunTiming timing;
  const auto start = std::chrono::steady_clock::now();
  const auto shell = make_shell(loaded.scenario, loaded.files);
  timing.shell = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto output =
      options.directory ? std::optional(*options.directory / run_directory(plan, number)) : std::nullopt;
  RunReport report = run_with_shell(loaded, shell, output, false, timing);
  report.targets.clear();  // they are in the run's files, and a batch may have very many
  return report;
}

}  // namespace

Vec3 start_shift(const Scenario& scenario, double length) {
  Random random(Random::derive(kJitterStream, static_cast<std::uint64_t>(scenario.seed)));
  return length * (lies_in_the_plane(scenario.environment) ? random.direction_in_plane() : random.direction());
}

BatchRun BatchPlan::run(std::size_t number) const {
  const std::size_t algorithms = definition.algorithms.size(), seeds = definition.seeds;
  return {number / (algorithms * seeds), number / seeds % algorithms, number % seeds};
}

BatchPlan plan_batch(BatchDefinition definition) {
  BatchPlan plan;
  plan.names = names_of(definition.scenarios);
  for (const fs::path& file : definition.scenarios) plan.scenarios.push_back(read_scenario_text(file));
  plan.definition = std::move(definition);
  if (plan.size() > kMostRuns) {
    throw InputError(fmt::format("got {} scenarios x {} algorithms x {} seeds = {} runs; allowed: at most {}",
                                 plan.scenarios.size(), plan.definition.algorithms.size(), plan.definition.seeds,
                                 plan.size(), kMostRuns));
  }
  for (std::size_t s = 0; s < plan.scenarios.size(); ++s) {
    std::vector<std::string> common;  // to all algorithms: what only one of them reads has an effect here
    for (std::size_t a = 0; a < plan.definition.algorithms.size(); ++a) {
      const LoadedScenario loaded = load(plan, s, a);
      if (a == 0) {  // the files are those of the scenario
        check_seeds_and_jitter(plan.definition, loaded);
        add(plan.warnings, check_named_files(loaded));
        common = loaded.warnings;
      }
      std::erase_if(common, [&loaded](const std::string& warning) { return !contains(loaded.warnings, warning); });
    }
    add(plan.warnings, std::move(common));
  }
  return plan;
}

LoadedScenario scenario_of(const BatchPlan& plan, std::size_t number) {
  const BatchRun run = plan.run(number);
  LoadedScenario loaded = load(plan, run.scenario, run.algorithm);
  Scenario& scenario = loaded.scenario;
  scenario.seed += static_cast<std::int64_t>(run.seed);
  // Adding zero would change -0 to 0.
  if (plan.definition.jitter != 0.0) scenario.initial.position += start_shift(scenario, plan.definition.jitter);
  return loaded;
}

fs::path scenario_directory(const BatchPlan& plan, std::size_t scenario) {
  return plan.scenarios.size() > 1 ? fs::path(plan.names[scenario]) : fs::path();
}

fs::path run_directory(const BatchPlan& plan, std::size_t number) {
  const BatchRun run = plan.run(number);
  const fs::path directory = scenario_directory(plan, run.scenario) / plan.definition.algorithms[run.algorithm];
  return plan.definition.seeds > 1 ? directory / fmt::format("{}{}", kSeedDirectory, run.seed) : directory;
}

BatchReport run_batch(const BatchPlan& plan, const BatchOptions& options) {
  BatchReport report;
  report.runs.resize(plan.size());
  for_each_job(plan.size(), {static_cast<unsigned>(options.jobs), options.progress ? "compare" : ""},
               [&](std::size_t number) { report.runs[number] = run_one(plan, options, number); });
  return report;
}

}  // namespace hapbench
