#include "results/summary/metric_list.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

Metric number(const char* name, std::optional<double> value) {
  return {name, value && std::isfinite(*value) ? Metric::Value(*value) : Metric::Value()};
}

/// A number that need not exist.
Metric number_if(bool exists, const char* name, double value) {
  return number(name, exists ? std::optional(value) : std::nullopt);
}

Metric count(const char* name, std::uint64_t value) {
  return {name, value};
}

/// A count that need not exist.
Metric count_if(bool exists, const char* name, std::uint64_t value) {
  return {name, exists ? Metric::Value(value) : Metric::Value()};
}

MetricList metric_list(const TrajectoryErrors& e) {
  const bool any = e.rows > 0;
  return {count("rows", e.rows),
          number_if(any, "height_error_mean_m", e.height_mean),
          number_if(any, "height_error_rms_m", e.height_rms),
          number_if(any, "height_error_min_m", e.height_min),
          number_if(any, "height_error_max_m", e.height_max),
          number_if(any, "lateral_error_mean_m", e.lateral_mean),
          number_if(any, "lateral_error_rms_m", e.lateral_rms),
          number_if(any, "lateral_error_max_m", e.lateral_max_abs),
          number_if(any, "interpenetration_mean_m", e.interpenetration_mean),
          number_if(any, "interpenetration_max_m", e.interpenetration_max)};
}

MetricList metric_list(const SubjectMean& m) {
  const bool any = m.subjects > 0;
  return {number_if(any, "mean", m.mean), number_if(any, "standard_error", m.standard_error),
          count("subjects", m.subjects)};
}

}  // namespace

Metric::Value value_of(const MetricList& list, std::string_view name) {
  const auto metric = std::find_if(list.begin(), list.end(), [name](const Metric& m) { return m.name == name; });
  return metric != list.end() ? metric->value : Metric::Value();
}

std::optional<double> number_of(const Metric::Value& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*count);
  const auto* real = std::get_if<double>(&value);
  return real != nullptr ? std::optional(*real) : std::nullopt;
}

void append(MetricList& list, std::string_view section, const MetricList& more) {
  const std::string prefix = section.empty() ? "" : std::string(section) + ".";
  for (const Metric& metric : more) list.push_back({prefix + metric.name, metric.value});
}

MetricList metric_list(const Metrics& m) {
  const bool any = m.rows > 0;
  const auto ratio = m.ratio.value_or(RatioRange{});
  const auto friction = m.explicit_friction.value_or(ExplicitFriction{});
  return {number("force_max_N", m.force_max),
          number("force_step_max_N", m.force_step_max),
          number("velocity_total_variation_m_per_s", m.velocity_total_variation),
          count("force_reversals", m.force_reversals),
          number("vibration_power_above_30Hz_m2_per_s2", m.vibration_power),
          number("depth_max_m", m.depth_max),
          number_if(m.ratio.has_value(), "ratio_min", ratio.min),
          number_if(m.ratio.has_value(), "ratio_max", ratio.max),
          number_if(any, "colliding_mean", m.colliding_mean),
          count("colliding_max", m.colliding_max),
          number_if(any, "rendered_mean", m.rendered_mean),
          count("rendered_max", m.rendered_max),
          count("steps_in_contact", m.steps_in_contact),
          number_if(any, "contact_share", static_cast<double>(m.steps_in_contact) / static_cast<double>(m.rows)),
          number("last_contact_s", m.last_contact),
          number("speed_max_m_per_s", m.speed_max),
          number_if(m.explicit_friction.has_value(), "explicit_friction_limit_N", friction.limit),
          count_if(m.explicit_friction.has_value(), "explicit_friction_rows_beyond", friction.rows_beyond),
          count_if(friction.first_step.has_value(), "explicit_friction_first_step", friction.first_step.value_or(0))};
}

MetricList final_position_list(const Metrics& m) {
  const bool any = m.rows > 0;
  return {number_if(any, "final_position_m.x", m.final_position.x()),
          number_if(any, "final_position_m.y", m.final_position.y()),
          number_if(any, "final_position_m.z", m.final_position.z())};
}

MetricList metric_list(const std::optional<PassivityMetrics>& m) {
  const bool any = m.has_value();
  const PassivityMetrics p = m.value_or(PassivityMetrics{});
  return {number_if(any, "energy_min_J", p.energy_min), number_if(any, "time_of_min_s", p.time_of_min),
          number_if(any, "energy_end_J", p.energy_end), number_if(any, "net_created_J", p.net_created())};
}

MetricList metric_list(const EnergyMetrics& m) {
  const EnergyBalance& b = m.balance;
  return {number("created_sum_J", m.created_sum), number("created_max_J", m.created_max),
          number("created_J", b.created),         number("input_J", b.input),
          number("spring_J", b.spring),           number("damping_J", b.damping),
          number("rotation_J", b.rotation),       number("integration_J", b.integration),
          number("script_J", b.script),           number("hand_J", b.hand),
          number("actuator_J", b.actuator),       number("residual_max_J", m.residual_max)};
}

MetricList metric_list(const IdealTrajectoryMetrics& m) {
  MetricList list;
  append(list, "gentle", metric_list(m.gentle));
  append(list, "firm", metric_list(m.firm));
  list.push_back(count("rows_without_ideal", m.rows_without_ideal));
  return list;
}

MetricList metric_list(const std::vector<PlaceMetrics>& places) {
  MetricList list;
  for (const PlaceMetrics& place : places) {
    const std::string section = std::to_string(place.place);
    append(list, section + ".success_rate", metric_list(place.success_rate));
    append(list, section + ".completion_time_s", metric_list(place.completion_time));
    append(list, section + ".model_force_N", metric_list(place.model_force));
    append(list, section + ".speed_m_per_s", metric_list(place.speed));
  }
  return list;
}

}  // namespace hapbench
