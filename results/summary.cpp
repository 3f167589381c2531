#include "results/summary.hpp"

#include <cmath>
#include <optional>

#include "results/hash.hpp"
#include "results/io/json_text.hpp"
#include "results/outcome_names.hpp"

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

ordered_json work_json(const RunWork& work) {
  return {{"queries", work.search.queries},
          {"points_tested", work.search.points_tested},
          {"lists_rebuilt", work.search.lists_rebuilt},
          {"steps_skipped", work.steps_skipped},
          {"iterations", work.algorithm.iterations},
          {"points_dropped", work.algorithm.points_dropped},
          {"allocations", work.allocations}};
}

ordered_json provenance_json(const Provenance& p, const std::string& scenario_hash) {
  return {{"hapbench_version", p.version}, {"commit", p.commit}, {"compiler", p.compiler},
          {"build_type", p.build_type},    {"flags", p.flags},   {"cpu", p.cpu},
          {"scenario_hash", scenario_hash}};
}

}  // namespace

ordered_json summary_json(const RunSummary& run) {
  return {{"name", run.name},
          {"algorithm", run.algorithm},
          {"outcome", outcome_name(run.result.outcome)},
          {"expected", run.expected},
          {"steps", run.result.rows},
          {"duration_s", number_or_null(run.duration)},
          {"divergence", divergence_json(run.result)},
          {"metrics", metrics_json(run.metrics)},
          {"state_hash", hash_text(run.metrics.state_hash)},
          {"work", work_json(run.work)},
          {"provenance", provenance_json(run.provenance, run.scenario_hash)}};
}

std::string summary_text(const RunSummary& run) {
  return json_text(summary_json(run));
}

}  // namespace hapbench
