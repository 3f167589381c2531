#include "scenarios/batch/sweep_plan.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "algorithms/registry.hpp"
#include "results/io/columns.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/describe_scenario.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/metric_sections.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/overrides.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// Properties of a run's scenario that the plan needs.
struct CheckedRun {
  std::vector<std::string> warnings;
  MetricList metrics;
  /// Text that identifies the files that the scenario names: the folder of the scenario, and the JSON objects that name
  /// files.
  std::string files;
  AlgorithmOrigin origin;
};

CheckedRun check_run(const SweepPlan& plan, std::size_t run) {
  const LoadedScenario loaded = plan.cases.load(run);
  const Scenario& scenario = loaded.scenario;
  CheckedRun checked_run{with_files(loaded, loaded.warnings),
                         metrics_without_values(scenario, scenario.reference_force.has_value()), "",
                         find_algorithm(scenario.rendering.algorithm)->origin};
  if (loaded.files.all().empty()) return checked_run;
  const Json json = written_object(scenario);
  checked_run.files = loaded.file.parent_path().string() + "\n";
  for (const auto& file : loaded.files.all()) {
    const Json::json_pointer field(file->pointer());
    checked_run.files += file->pointer() + " " + json.at(field.parent_pointer()).dump() + "\n";
  }
  return checked_run;
}

using Names = std::set<std::string>;

void add_names(Names& names, const MetricList& metrics) {
  for (const Metric& metric : metrics) names.insert(metric.name);
}

/// Reads the files that the scenarios of `runs` name, and returns the hashes of the files. Adds the warnings about
/// scenarios and files to the plan. If a scenario replays a recorded motion, adds the names of the metrics of its run
/// to `metrics`; these metrics depend on whether the recording has a force.
Json check_files(SweepPlan& plan, const std::vector<std::size_t>& runs, Names& metrics) {
  Json hashes = Json::array();
  for (const std::size_t run : runs) {
    const CheckedScenario scene = checked(plan.cases.load(run));
    const LoadedScenario& loaded = scene.loaded();
    append_new(plan.warnings, with_files(loaded, scene.file_warnings()));
    if (std::holds_alternative<RecordedPosition>(loaded.scenario.motion.position))
      add_names(metrics, metrics_without_values(loaded));
    Scenario unnamed = loaded.scenario;
    unnamed.name.clear();  // the name may come from the scenario's file name
    hashes.push_back(with_file(loaded, [&] { return scenario_hash(effective_scenario(unnamed, {}), loaded.files); }));
  }
  return hashes;
}

/// Returns the values of an axis for SweepPlan::content. For a long range or a sampled range, returns only both ends,
/// the scale, and for a long range the number of values. For values from a file, returns only the path.
Json axis_content(const Axis& axis, bool from_file) {
  constexpr std::size_t kMaxListed = 10'000;
  Json content = {{"path", axis.path}};
  if (from_file) return content;
  if (axis.range && (axis.steps == 0 || axis.steps > kMaxListed)) {
    content["range"] = {axis.range->from, axis.range->to};
    content["scale"] = axis.range->logarithmic ? "log" : "linear";
    if (axis.steps > 0) content["count"] = axis.steps;
    return content;
  }
  content["values"] = Json::array();
  for (std::size_t i = 0; i < axis.size(); ++i) content["values"].push_back(axis.value(i));
  for (const Axis::Along& along : axis.along)
    content["along"].push_back({{"set", along.overrides}, {"metrics_every_rows", along.stride}});
  return content;
}

/// Returns a hash of the overrides of all cases.
std::string hash_of_points(const Cases& cases) {
  std::string text;
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const std::string& change : cases.changes(i)) text += change + "\n";
  return hash_text(hash_of(text));
}

/// Returns everything that determines the rows. Does not include the CPU, because shards of a sweep may come
/// from several machines.
Json content_of(const SweepPlan& plan, const Json& files, const Json& plugins) {
  const Provenance program = provenance();
  const std::vector<ScenarioText>& scenes = plan.cases.scenes();
  const auto& sampling = plan.cases.sampling();
  const bool from_file = sampling && sampling->method == kPointsOfFile;
  Json content;
  if (scenes.size() == 1) content["scenario"] = scenes[0].json;
  if (scenes.size() > 1)
    for (const ScenarioText& scene : scenes) content["scenarios"].push_back(scene.json);
  content["set"] = plan.cases.sets();
  content["vary"] = Json::array();
  for (const Axis& axis : plan.cases.axes()) content["vary"].push_back(axis_content(axis, from_file));
  if (sampling) content["sample"] = {{"method", sampling->method}, {"runs", sampling->count}};
  if (from_file) content["sample"]["hash"] = hash_of_points(plan.cases);
  if (sampling && !from_file) content["sample"]["seed"] = sampling->seed;
  content["files"] = files;
  if (plan.length == RunLength::until_failure) content["runs_end"] = "when they fail for good";
  if (!plugins.empty()) content["plugins"] = plugins;
  content["program"] = {{"hapbench_version", program.version},
                        {"commit", program.commit},
                        {"compiler", program.compiler},
                        {"build_type", program.build_type},
                        {"flags", program.flags}};
  return content;
}

}  // namespace

bool states_expectations(const Cases& cases, std::size_t run) {
  const std::vector<std::string> overrides = cases.overrides(run);
  const auto sets_expect = [](const std::string& override) {
    const std::string_view path = overridden_path(override);
    return path.substr(0, path.find('.')) == "expect";
  };
  if (std::ranges::any_of(overrides, sets_expect)) return true;
  return std::ranges::all_of(overrides, keeps_run_unchanged) && cases.scene(run).json.contains("expect");
}

std::vector<std::size_t> runs_to_check(const Cases& cases) {
  // Check all runs of a small batch, and the first runs of a sample.
  if (cases.size() <= kMaxChecked || cases.sampling()) {
    std::vector<std::size_t> runs(std::min(cases.size(), kMaxChecked));
    std::iota(runs.begin(), runs.end(), std::size_t{0});
    return runs;
  }
  // In a large grid, check only runs in which at most one field differs from the first run or from the last run.
  std::set<std::size_t> runs;
  std::size_t stride = 1;
  for (std::size_t a = cases.axes().size(); a-- > 0;) {
    const std::size_t size = cases.axes()[a].size(), count = std::min(size, kMaxChecked);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t index = count == 1 ? 0 : i * (size - 1) / (count - 1);
      runs.insert(index * stride);
      if (cases.axes().size() > 1) runs.insert(cases.size() - 1 - index * stride);
    }
    stride *= size;
  }
  return {runs.begin(), runs.end()};
}

SweepPlan plan_sweep(Cases cases, const JobOptions& jobs, RunLength length) {
  SweepPlan plan{std::move(cases), length};
  if (const auto& sampling = plan.cases.sampling(); sampling && !sampling->warning.empty())
    plan.warnings.push_back(sampling->warning);
  // Load the scenarios of the runs to check.
  const std::vector<std::size_t> runs = runs_to_check(plan.cases);
  std::vector<CheckedRun> checked_runs(runs.size());
  for_each_job(runs.size(), jobs, [&](std::size_t i) { checked_runs[i] = check_run(plan, runs[i]); });
  // Collect their metrics, warnings and combinations of files.
  Names metrics;
  std::map<std::string, std::string> plugins;
  Names files;                               // combinations of named files
  std::vector<std::size_t> runs_with_files;  // first run with each combination
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const CheckedRun& run = checked_runs[i];
    add_names(metrics, run.metrics);
    append_new(plan.warnings, run.warnings);
    if (!run.origin.file.empty()) plugins.emplace(run.origin.file, run.origin.hash);
    if (!run.files.empty() && files.insert(run.files).second) runs_with_files.push_back(runs[i]);
  }
  // Read each combination of files once.
  const Json hashes = check_files(plan, runs_with_files, metrics);
  // List the collected metrics in the order in which the program lists all metrics.
  for (const Metric& metric : metrics_without_values(TrackingHandFields::kMaxTargetPositions)) {
    if (!metrics.contains(metric.name)) continue;
    plan.metrics.push_back(metric.name);
    if (metric.bounded) plan.bounded.push_back(metric.name);
  }
  plan.content = content_of(plan, hashes, plugins);
  plan.definition = hash_text(hash_of(json_text(plan.content)));
  return plan;
}

}  // namespace hapbench
