#include "results/summary/summary.hpp"

#include <cmath>

#include "sim/core/hash.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {
namespace {

using nlohmann::ordered_json;

ordered_json number_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json(nullptr);
}

double seconds(std::uint64_t nanoseconds) {
  // Division by 1e9 returns the double nearest to the exact quotient; multiplication by 1e-9 would not.
  return static_cast<double>(nanoseconds) / 1e9;
}

ordered_json divergence_json(const RunEnd& result) {
  if (result.outcome != Outcome::diverges) return nullptr;
  const Divergence& d = result.divergence;
  ordered_json json = {{"step", d.step},
                       {"time_s", number_or_null(d.time)},
                       {"quantity", d.quantity},
                       {"magnitude", number_or_null(d.magnitude)},
                       {"bound", number_or_null(d.bound)}};
  if (!std::isfinite(d.magnitude)) json["magnitude_text"] = std::isnan(d.magnitude) ? "nan" : "inf";
  if (!d.fault.empty()) json["fault"] = d.fault;
  return json;
}

/// Returns a JSON object with the tolerance of each metric that has a tolerance, by the full name of the metric.
ordered_json tolerances_json(const MetricList& list) {
  ordered_json json = ordered_json::object();
  for (const Metric& metric : list)
    if (const auto tolerance = metric.tolerance()) json[metric.name] = *tolerance;
  return json;
}

/// Returns the array [x, y, z] of a vector. `xyz` points to the metric of x; the metrics of y and z follow it. Returns
/// null if the metric of x has no value.
ordered_json vector_json(const Metric* xyz) {
  if (std::holds_alternative<std::monostate>(xyz->value)) return nullptr;
  return {cell_json(xyz[0].value), cell_json(xyz[1].value), cell_json(xyz[2].value)};
}

/// Adds each metric to the object of its section. Metrics without a section go to "metrics". Dots in a name create
/// nested objects; vectors become arrays.
void add_metrics(ordered_json& json, const MetricList& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    // Find the object of the metric's section.
    std::string_view name = list[i].name;
    const std::string section(name.substr(0, name.find('.')));
    const bool in_section = section.size() < name.size() && json.contains(section);
    ordered_json* object = &json[in_section ? section : "metrics"];
    if (in_section) name.remove_prefix(section.size() + 1);
    // Write a vector as one array.
    if (name.ends_with(".x")) {
      (*object)[std::string(name.substr(0, name.size() - 2))] = vector_json(&list[i]);
      i += 2;
      continue;
    }
    // Create nested objects for dots in the name.
    for (std::size_t dot; (dot = name.find('.')) != std::string_view::npos; name.remove_prefix(dot + 1))
      object = &(*object)[std::string(name.substr(0, dot))];
    (*object)[std::string(name)] = cell_json(list[i].value);
  }
}

ordered_json finding_json(const Diagnosed& f) {
  return {{"rule", f.rule},           {"number", f.number}, {"unit", f.unit},  {"value", f.value},
          {"threshold", f.threshold}, {"says", f.says},     {"try", f.attempt}};
}

ordered_json work_json(const RunWork& work) {
  return {{"queries", work.search.queries},
          {"points_tested", work.search.points_tested},
          {"lists_rebuilt", work.search.lists_rebuilt},
          {"steps_skipped", work.steps_skipped},
          {"iterations", work.algorithm.iterations},
          {"points_dropped", work.algorithm.points_dropped},
          {"steps_controlled", work.algorithm.steps_controlled},
          {"allocations", work.allocations}};
}

ordered_json provenance_json(const Provenance& p, const std::string& scenario_hash) {
  ordered_json json = {{"hapbench_version", p.version}, {"commit", p.commit}, {"compiler", p.compiler},
                       {"build_type", p.build_type},    {"flags", p.flags},   {"cpu", p.cpu},
                       {"scenario_hash", scenario_hash}};
  if (!p.plugin.empty()) json["plugin"] = {{"file", p.plugin}, {"hash", p.plugin_hash}};
  return json;
}

}  // namespace

ordered_json tool_json(const ToolShape& tool) {
  ordered_json outline = ordered_json::array();
  for (const auto& [s, rho] : tool.outline()) outline.push_back({s, rho});
  return {{"half_width_m", tool.half_width()},
          {"reach_m", tool.reach()},
          {"convex", tool.convex()},
          {"outline_m", std::move(outline)}};
}

ordered_json summary_json(const Result& run) {
  ordered_json warnings = ordered_json::array();
  for (const Warning& warning : run.warnings) warnings.push_back(warning.located_text());
  ordered_json json = {{"name", run.name},
                       {"algorithm", run.algorithm},
                       {"outcome", outcome_name(run.end.outcome)},
                       {"expected", run.expected},
                       {"steps", run.end.rows},
                       {"duration_s", number_or_null(run.duration)},
                       {"ended_at_s", number_or_null(run.end.ended_at)},
                       {"divergence", divergence_json(run.end)},
                       {"warnings", warnings}};
  if (run.diagnosis) {
    json["diagnosis"] = ordered_json::array();
    for (const Diagnosed& finding : *run.diagnosis) json["diagnosis"].push_back(finding_json(finding));
  }
  // Create the sections first, to fix their order.
  json["metrics"] = ordered_json::object();
  for (const auto& [section, members] : run.sections.items()) {
    json[section] = ordered_json::object();
    if (section == "passivity" && !run.tool.is_null()) json["tool"] = run.tool;
  }
  add_metrics(json, run.metrics);
  for (const auto& [section, members] : run.sections.items()) json[section].update(members);
  json["tolerances"] = tolerances_json(run.metrics);
  json["state_hash"] = hash_text(run.state_hash);
  json["work"] = work_json(run.work);
  json["provenance"] = provenance_json(run.provenance, run.scenario_hash);
  return json;
}

ordered_json step_latency_json(const StepLatency& latency) {
  const auto known = [&latency](std::uint64_t ns) { return number_or_null(if_any(latency.steps > 0, seconds(ns))); };
  ordered_json json = {{"steps", latency.steps},
                       {"clock_overhead_s", seconds(latency.overhead)},
                       {"p50_s", known(latency.p50)},
                       {"p95_s", known(latency.p95)},
                       {"p99_s", known(latency.p99)},
                       {"p99_9_s", known(latency.p99_9)},
                       {"max_s", known(latency.max)},
                       {"deadline_misses", ordered_json::array()},
                       {"histogram", ordered_json::array()},
                       {"over_time_s", ordered_json::array()}};
  for (std::size_t i = 0; i < kStepDeadlines.size(); ++i) {
    json["deadline_misses"].push_back({{"deadline_s", kStepDeadlines[i]}, {"steps", latency.misses[i]}});
  }
  for (const StepLatency::Bin& bin : latency.histogram) {
    json["histogram"].push_back({{"from_s", seconds(bin.from)}, {"to_s", seconds(bin.to)}, {"steps", bin.steps}});
  }
  for (const std::uint64_t median : latency.over_time) json["over_time_s"].push_back(seconds(median));
  return json;
}

std::string timing_text(const Result& run) {
  const RunTiming& timing = run.timing;
  const Provenance& build = run.provenance;
  const auto mean = if_any(run.end.rows > 0, timing.loop / static_cast<double>(run.end.rows));
  return json_text({{"shell_s", timing.shell},
                    {"loop_s", timing.loop},
                    {"steps", run.end.rows},
                    {"step_mean_s", number_or_null(mean)},
                    {"step_p50_s", number_or_null(timing.step_p50)},
                    {"step_p99_s", number_or_null(timing.step_p99)},
                    {"step_latency", timing.latency ? step_latency_json(*timing.latency) : ordered_json(nullptr)},
                    {"preemptions", timing.preemptions},
                    {"build",
                     {{"march", build.march},
                      {"instruction_set", build.widest},
                      {"simd", build.simd},
                      {"compiler", build.compiler},
                      {"build_type", build.build_type},
                      {"flags", build.flags},
                      {"commit", build.commit}}},
                    {"cpu", build.cpu}});
}

}  // namespace hapbench
