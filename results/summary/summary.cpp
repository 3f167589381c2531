#include "results/summary/summary.hpp"

#include <cmath>
#include <optional>

#include "results/io/json_text.hpp"
#include "results/summary/outcome_names.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

using nlohmann::ordered_json;

ordered_json number_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json divergence_json(const SimulationResult& result) {
  if (result.outcome != Outcome::diverges) return nullptr;
  const Divergence& d = result.divergence;
  ordered_json json = {{"step", d.step},
                       {"time_s", number_or_null(d.time)},
                       {"quantity", d.quantity},
                       {"magnitude", number_or_null(d.magnitude)},
                       {"bound", number_or_null(d.bound)}};
  if (!std::isfinite(d.magnitude)) json["magnitude_text"] = std::isnan(d.magnitude) ? "nan" : "inf";
  return json;
}

ordered_json metrics_json(const Metrics& m) {
  const bool any = m.rows > 0;
  const auto if_any = [any](double value) { return number_or_null(any ? std::optional(value) : std::nullopt); };
  const Vec3& p = m.final_position;
  return {{"force_max_N", number_or_null(m.force_max)},
          {"force_step_max_N", number_or_null(m.force_step_max)},
          {"velocity_total_variation_m_per_s", number_or_null(m.velocity_total_variation)},
          {"force_reversals", m.force_reversals},
          {"vibration_power_above_30Hz_m2_per_s2", number_or_null(m.vibration_power)},
          {"depth_max_m", number_or_null(m.depth_max)},
          {"ratio_min", number_or_null(m.ratio ? std::optional(m.ratio->min) : std::nullopt)},
          {"ratio_max", number_or_null(m.ratio ? std::optional(m.ratio->max) : std::nullopt)},
          {"colliding_mean", if_any(m.colliding_mean)},
          {"colliding_max", m.colliding_max},
          {"rendered_mean", if_any(m.rendered_mean)},
          {"rendered_max", m.rendered_max},
          {"steps_in_contact", m.steps_in_contact},
          {"speed_max_m_per_s", number_or_null(m.speed_max)},
          {"final_position_m", any ? ordered_json({p.x(), p.y(), p.z()}) : ordered_json(nullptr)}};
}

ordered_json passivity_json(const std::optional<PassivityMetrics>& m) {
  const auto if_any = [&m](auto value) { return number_or_null(m ? std::optional(value(*m)) : std::nullopt); };
  return {{"energy_min_J", if_any([](const auto& p) { return p.energy_min; })},
          {"time_of_min_s", if_any([](const auto& p) { return p.time_of_min; })},
          {"energy_end_J", if_any([](const auto& p) { return p.energy_end; })},
          {"net_created_J", if_any([](const auto& p) { return p.net_created(); })}};
}

ordered_json event_json(const EnergyEvent& e) {
  return {{"step", e.step},
          {"time_s", number_or_null(e.time)},
          {"created_J", number_or_null(e.created)},
          {"colliding", {e.colliding_before, e.colliding_after}},
          {"rendered", {e.rendered_before, e.rendered_after}},
          {"appeared", e.appeared},
          {"vanished", e.vanished}};
}

ordered_json energy_json(const EnergyMetrics& m) {
  const EnergyBalance& b = m.balance;
  ordered_json json = {{"created_sum_J", number_or_null(m.created_sum)},
                       {"created_max_J", number_or_null(m.created_max)},
                       {"created_J", number_or_null(b.created)},
                       {"input_J", number_or_null(b.input)},
                       {"spring_J", number_or_null(b.spring)},
                       {"damping_J", number_or_null(b.damping)},
                       {"rotation_J", number_or_null(b.rotation)},
                       {"integration_J", number_or_null(b.integration)},
                       {"script_J", number_or_null(b.script)},
                       {"hand_J", number_or_null(b.hand)},
                       {"actuator_J", number_or_null(b.actuator)},
                       {"residual_max_J", number_or_null(m.residual_max)},
                       {"events", ordered_json::array()}};
  for (const EnergyEvent& event : m.events) json["events"].push_back(event_json(event));
  return json;
}

ordered_json errors_json(const TrajectoryErrors& e) {
  const auto if_any = [&e](double value) { return number_or_null(e.rows > 0 ? std::optional(value) : std::nullopt); };
  return {{"rows", e.rows},
          {"height_error_mean_m", if_any(e.height_mean)},
          {"height_error_rms_m", if_any(e.height_rms)},
          {"height_error_min_m", if_any(e.height_min)},
          {"height_error_max_m", if_any(e.height_max)},
          {"lateral_error_mean_m", if_any(e.lateral_mean)},
          {"lateral_error_rms_m", if_any(e.lateral_rms)},
          {"lateral_error_max_m", if_any(e.lateral_max_abs)},
          {"interpenetration_mean_m", if_any(e.interpenetration_mean)},
          {"interpenetration_max_m", if_any(e.interpenetration_max)}};
}

ordered_json ideal_trajectory_json(const IdealTrajectoryMetrics& m) {
  return {
      {"gentle", errors_json(m.gentle)}, {"firm", errors_json(m.firm)}, {"rows_without_ideal", m.rows_without_ideal}};
}

ordered_json subject_mean_json(const SubjectMean& m) {
  const bool any = m.subjects > 0;
  return {{"mean", number_or_null(any ? std::optional(m.mean) : std::nullopt)},
          {"standard_error", number_or_null(any ? std::optional(m.standard_error) : std::nullopt)},
          {"subjects", m.subjects}};
}

ordered_json targets_json(const std::vector<PlaceMetrics>& places) {
  ordered_json json = ordered_json::object();
  for (const PlaceMetrics& place : places) {
    json[std::to_string(place.place)] = {{"success_rate", subject_mean_json(place.success_rate)},
                                         {"completion_time_s", subject_mean_json(place.completion_time)},
                                         {"model_force_N", subject_mean_json(place.model_force)},
                                         {"speed_m_per_s", subject_mean_json(place.speed)}};
  }
  return json;
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
  return {{"hapbench_version", p.version}, {"commit", p.commit}, {"compiler", p.compiler},
          {"build_type", p.build_type},    {"flags", p.flags},   {"cpu", p.cpu},
          {"scenario_hash", scenario_hash}};
}

}  // namespace

ordered_json summary_json(const RunSummary& run) {
  ordered_json json = {{"name", run.name},
                       {"algorithm", run.algorithm},
                       {"outcome", outcome_name(run.result.outcome)},
                       {"expected", run.expected},
                       {"steps", run.result.rows},
                       {"duration_s", number_or_null(run.duration)},
                       {"divergence", divergence_json(run.result)},
                       {"metrics", metrics_json(run.metrics)},
                       {"passivity", passivity_json(run.passivity)}};
  if (run.energy) json["energy"] = energy_json(*run.energy);
  if (run.ideal_trajectory) json["ideal_trajectory"] = ideal_trajectory_json(*run.ideal_trajectory);
  if (run.targets) json["targets"] = targets_json(*run.targets);
  json["state_hash"] = hash_text(run.metrics.state_hash);
  json["work"] = work_json(run.work);
  json["provenance"] = provenance_json(run.provenance, run.scenario_hash);
  return json;
}

namespace {

/// Adds every number and null below `json` under its path.
void flatten(const ordered_json& json, const std::string& path, ordered_json& out) {
  for (const auto& entry : json.items()) {
    const std::string name = path.empty() ? entry.key() : path + "." + entry.key();
    if (entry.value().is_object()) flatten(entry.value(), name, out);
    if (entry.value().is_number() || entry.value().is_null()) out[name] = entry.value();
  }
}

}  // namespace

ordered_json boundable_metrics(const RunSummary& run) {
  const ordered_json summary = summary_json(run);
  ordered_json out = ordered_json::object();
  flatten(summary["metrics"], "", out);
  const char* const axes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const bool any = run.metrics.rows > 0;
    const double coordinate = run.metrics.final_position[i];
    out[std::string("final_position_m.") + axes[i]] = any ? number_or_null(coordinate) : ordered_json(nullptr);
  }
  for (const char* section : {"passivity", "energy", "ideal_trajectory", "targets"}) {
    if (summary.contains(section)) flatten(summary[section], section, out);
  }
  return out;
}

std::string summary_text(const RunSummary& run) {
  return json_text(summary_json(run));
}

}  // namespace hapbench
