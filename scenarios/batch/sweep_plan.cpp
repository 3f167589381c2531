#include "scenarios/batch/sweep_plan.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <numeric>
#include <utility>

#include "results/io/json_text.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/descriptions.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// The facts about one run's scenario that the sweep needs.
struct Point {
  std::vector<std::string> warnings;
  MetricSections sections;
  std::string environment;  ///< with all defaults
  std::string files;        ///< the parts that name files
};

MetricSections sections_of(const Scenario& scenario) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  return {scenario.record.energy, scenario.record.ideal_trajectory, hand == nullptr ? 0 : hand->task.places.size()};
}

Point examine(const SweepPlan& plan, std::size_t run) {
  const LoadedScenario loaded = scenario_of(plan, run);
  const Scenario& scenario = loaded.scenario;
  Point point{loaded.warnings, sections_of(scenario), written(scenario.environment).dump(), ""};
  if (std::holds_alternative<PointShellEnvironment>(scenario.environment) ||
      std::holds_alternative<MeshEnvironment>(scenario.environment)) {
    point.files = point.environment;
  }
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position)) {
    point.files += written_object(scenario.motion).dump();
  }
  return point;
}

/// Collects the points of a plan, one by one in whatever order; the outcome does not depend on it.
class Collector {
 public:
  explicit Collector(SweepPlan& plan) : plan_(plan), environments_of_runs_(plan.points.size()) {}

  void add(std::size_t run, const Point& point) {
    sections_.energy |= point.sections.energy;
    sections_.ideal_trajectory |= point.sections.ideal_trajectory;
    sections_.places = std::max(sections_.places, point.sections.places);
    environments_of_runs_[run] = &*environments_.emplace(point.environment, 0).first;
    if (!point.files.empty()) keep_first(files_, point.files, {run, 0});
    for (std::size_t i = 0; i < point.warnings.size(); ++i) keep_first(warnings_, point.warnings[i], {run, i});
  }

  /// When all have been added.
  void finish() {
    plan_.metrics = metric_names(sections_);
    for (Environments::value_type* environment : environments_of_runs_) {
      if (environment->second == 0) environment->second = ++plan_.environment_count;
      plan_.environments.push_back(environment->second - 1);
    }
    for (const auto& [place, warning] : in_order(warnings_)) plan_.warnings.push_back(warning);
  }

  /// Reads what the scenarios name, each file once for each use, and hashes it.
  Json check_files() {
    Json hashes = Json::array();
    for (const auto& [place, names] : in_order(files_)) {
      LoadedScenario loaded = scenario_of(plan_, place.first);
      for (std::string& warning : check_named_files(loaded)) {
        const auto end = plan_.warnings.end();
        if (std::find(plan_.warnings.begin(), end, warning) == end) plan_.warnings.push_back(std::move(warning));
      }
      loaded.scenario.name.clear();  // which may be that of the scenario's file
      hashes.push_back(with_file(loaded, [&] { return scenario_hash(loaded.scenario, loaded.files); }));
    }
    return hashes;
  }

 private:
  /// Where something first occurs: run, and number within the run.
  using Place = std::pair<std::size_t, std::size_t>;
  using FirstPlaces = std::map<std::string, Place>;
  using Environments = std::map<std::string, std::size_t>;

  static void keep_first(FirstPlaces& places, const std::string& text, Place place) {
    Place& first = places.emplace(text, place).first->second;
    first = std::min(first, place);
  }
  static std::map<Place, std::string> in_order(const FirstPlaces& places) {
    std::map<Place, std::string> order;
    for (const auto& [text, place] : places) order.emplace(place, text);
    return order;
  }

  SweepPlan& plan_;
  MetricSections sections_{false, false, 0};
  Environments environments_;  ///< numbered from 1 in the order of runs, at the end
  std::vector<Environments::value_type*> environments_of_runs_;
  FirstPlaces files_, warnings_;
};

/// Fills the collector; throws the error of the lowest run that has one.
void examine_all(const SweepPlan& plan, std::size_t jobs, bool progress, Collector& collector) {
  std::vector<std::size_t> runs(plan.points.size());
  std::iota(runs.begin(), runs.end(), std::size_t{0});
  ProgressBar bar("checking", runs.size(), progress);
  std::size_t done = 0;
  std::map<std::size_t, std::exception_ptr> errors;
  // Runs start in order, so when any run fails, the lowest one that will fail has at least been started.
  std::atomic<bool> failed = false;
  const auto work = [&](std::size_t run) -> Delivery {
    try {
      return [&, run, point = examine(plan, run)] {
        collector.add(run, point);
        bar.show(++done, true);
      };
    } catch (const InputError&) {
      failed = true;
      return [&errors, run, error = std::current_exception()] { errors[run] = error; };
    }
  };
  parallel_for(runs, jobs, work, [&failed] { return failed.load(); });
  if (!errors.empty()) std::rethrow_exception(errors.begin()->second);
}

Json axis_content(const Axis& axis) {
  if (!axis.range) return {{"path", axis.path}, {"values", axis.values}};
  return {{"path", axis.path},
          {"range", {axis.range->from, axis.range->to}},
          {"scale", axis.range->logarithmic ? "log" : "linear"}};
}

/// The CPU does not count: shards of one sweep may come from several machines.
Json content_of(const SweepPlan& plan, const Json& files) {
  const Provenance program = provenance();
  Json vary = Json::array();
  for (const Axis& axis : plan.points.axes()) vary.push_back(axis_content(axis));
  Json content = {{"scenario", plan.scenario.json}, {"set", plan.overrides}, {"vary", std::move(vary)}};
  if (const auto& sampling = plan.points.sampling()) {
    content["sample"] = {
        {"method", sampling_name(sampling->method)}, {"runs", sampling->count}, {"seed", sampling->seed}};
  }
  content["files"] = files;
  content["program"] = {{"hapbench_version", program.version},
                        {"commit", program.commit},
                        {"compiler", program.compiler},
                        {"build_type", program.build_type},
                        {"flags", program.flags}};
  return content;
}

}  // namespace

SweepPlan plan_sweep(ScenarioText scenario, std::vector<std::string> overrides, SweepPoints points, std::size_t jobs,
                     bool progress) {
  SweepPlan plan{std::move(scenario), std::move(overrides), std::move(points), {}, {}, {}, 0, {}, ""};
  Collector collector(plan);
  examine_all(plan, jobs, progress, collector);
  collector.finish();
  plan.content = content_of(plan, collector.check_files());
  plan.definition = hash_text(hash_of(json_text(plan.content)));
  return plan;
}

LoadedScenario scenario_of(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> overrides = plan.overrides;
  for (std::string& override : plan.points.overrides(run)) overrides.push_back(std::move(override));
  return load_scenario(plan.scenario, overrides);
}

}  // namespace hapbench
