#include "scenarios/batch/sweep_plan.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "algorithms/registry.hpp"
#include "results/io/json_text.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/descriptions.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

/// The facts about one run's scenario that the sweep needs.
struct Point {
  std::vector<std::string> warnings;
  SectionParts sections;
  std::string files;  ///< the parts that name files
  AlgorithmOrigin origin;
};

Point examine(const SweepPlan& plan, std::size_t run) {
  const LoadedScenario loaded = scenario_of(plan, run);
  const Scenario& scenario = loaded.scenario;
  Point point{loaded.warnings, sections_of(scenario, scenario.reference_force.has_value()), "",
              find_algorithm(scenario.rendering.algorithm)->origin};
  if (std::holds_alternative<PointShellEnvironment>(scenario.environment) ||
      std::holds_alternative<MeshEnvironment>(scenario.environment)) {
    point.files = written(scenario.environment).dump();
  }
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position)) {
    point.files += written_object(scenario.motion).dump();
  }
  return point;
}

/// Collects the points of a plan, one by one in whatever order; the outcome does not depend on it.
class Collector {
 public:
  explicit Collector(SweepPlan& plan) : plan_(plan) {}

  void add(std::size_t run, const Point& point) {
    add_sections(sections_, point.sections);
    if (!point.origin.file.empty()) plugins_.emplace(point.origin.file, point.origin.hash);
    if (!point.files.empty()) keep_first(files_, point.files, {run, 0});
    for (std::size_t i = 0; i < point.warnings.size(); ++i) keep_first(warnings_, point.warnings[i], {run, i});
  }

  /// Puts the warnings into the plan. Call it when all points have been added.
  void set_warnings() {
    for (const auto& [place, warning] : in_order(warnings_)) plan_.warnings.push_back(warning);
  }

  /// The files that algorithms come from, with their hashes.
  const std::map<std::string, std::string>& plugins() const { return plugins_; }

  /// The metrics that some run has; call it after check_files.
  std::vector<std::string> metrics() const { return metric_names(sections_); }

  /// Reads what the scenarios name, each file once for each use, and hashes it.
  Json check_files() {
    Json hashes = Json::array();
    for (const auto& [place, names] : in_order(files_)) {
      LoadedScenario loaded = scenario_of(plan_, place.first);
      for (std::string& warning : check_named_files(loaded)) {
        const auto end = plan_.warnings.end();
        if (std::find(plan_.warnings.begin(), end, warning) == end) plan_.warnings.push_back(std::move(warning));
      }
      if (std::holds_alternative<RecordedPosition>(loaded.scenario.motion.position))
        add_sections(sections_, sections_of(loaded.scenario, loaded.files.recorded_force() != nullptr));
      loaded.scenario.name.clear();  // which may be that of the scenario's file
      hashes.push_back(with_file(loaded, [&] { return scenario_hash(loaded.scenario, loaded.files); }));
    }
    return hashes;
  }

 private:
  /// Where something first occurs: run, and number within the run.
  using Place = std::pair<std::size_t, std::size_t>;
  using FirstPlaces = std::map<std::string, Place>;

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
  SectionParts sections_;
  FirstPlaces files_, warnings_;
  std::map<std::string, std::string> plugins_;
};

/// Fills the collector; throws the error of the lowest run that has one.
void examine_all(const SweepPlan& plan, std::size_t jobs, bool progress, Collector& collector) {
  const std::vector<std::size_t> runs = runs_to_check(plan.points);
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

/// A grid's values one by one, but for ranges of very many.
Json axis_content(const Axis& axis) {
  constexpr std::size_t kMostListed = 10'000;
  if (!axis.range || (axis.steps > 0 && axis.steps <= kMostListed)) {
    Json values = Json::array();
    for (std::size_t i = 0; i < axis.size(); ++i) values.push_back(axis.value(i));
    return {{"path", axis.path}, {"values", std::move(values)}};
  }
  Json content = {{"path", axis.path},
                  {"range", {axis.range->from, axis.range->to}},
                  {"scale", axis.range->logarithmic ? "log" : "linear"}};
  if (axis.steps > 0) content["count"] = axis.steps;
  return content;
}

/// The CPU does not count: shards of one sweep may come from several machines.
Json content_of(const SweepPlan& plan, const Json& files, const Json& plugins) {
  const Provenance program = provenance();
  Json vary = Json::array();
  for (const Axis& axis : plan.points.axes()) vary.push_back(axis_content(axis));
  Json content = {{"scenario", plan.scenario.json}, {"set", plan.overrides}, {"vary", std::move(vary)}};
  if (const auto& sampling = plan.points.sampling()) {
    content["sample"] = {
        {"method", sampling_name(sampling->method)}, {"runs", sampling->count}, {"seed", sampling->seed}};
  }
  content["files"] = files;
  if (!plugins.empty()) content["plugins"] = plugins;
  content["program"] = {{"hapbench_version", program.version},
                        {"commit", program.commit},
                        {"compiler", program.compiler},
                        {"build_type", program.build_type},
                        {"flags", program.flags}};
  return content;
}

}  // namespace

std::vector<std::size_t> runs_to_check(const SweepPoints& points) {
  if (points.size() <= kMostChecked || points.sampling()) {
    std::vector<std::size_t> runs(std::min(points.size(), kMostChecked));
    std::iota(runs.begin(), runs.end(), std::size_t{0});
    return runs;
  }
  std::set<std::size_t> runs;
  std::size_t stride = 1;
  for (std::size_t a = points.axes().size(); a-- > 0;) {
    const std::size_t size = points.axes()[a].size(), count = std::min(size, kMostChecked);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = count == 1 ? 0 : i * (size - 1) / (count - 1);
      runs.insert(place * stride);
      if (points.axes().size() > 1) runs.insert(points.size() - 1 - place * stride);
    }
    stride *= size;
  }
  return {runs.begin(), runs.end()};
}

SweepPlan plan_sweep(ScenarioText scenario, std::vector<std::string> overrides, SweepPoints points, std::size_t jobs,
                     bool progress) {
  SweepPlan plan{std::move(scenario), std::move(overrides), std::move(points), {}, {}, {}, ""};
  Collector collector(plan);
  examine_all(plan, jobs, progress, collector);
  collector.set_warnings();
  plan.content = content_of(plan, collector.check_files(), collector.plugins());
  plan.metrics = collector.metrics();
  plan.definition = hash_text(hash_of(json_text(plan.content)));
  return plan;
}

std::vector<std::string> overrides_of(const SweepPlan& plan, std::size_t run) {
  std::vector<std::string> overrides = plan.overrides;
  for (std::string& override : plan.points.overrides(run)) overrides.push_back(std::move(override));
  return overrides;
}

LoadedScenario scenario_of(const SweepPlan& plan, std::size_t run) {
  return load_scenario(plan.scenario, overrides_of(plan, run));
}

}  // namespace hapbench
