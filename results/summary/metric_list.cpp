#include "results/summary/metric_list.hpp"

#include <algorithm>
#include <cmath>

#include "results/io/number_text.hpp"

namespace hapbench {
namespace {

Metric number(const char* name, const char* unit, const char* meaning, std::optional<double> value) {
  return {name, unit, meaning, value && std::isfinite(*value) ? Metric::Value(*value) : Metric::Value()};
}

/// A number that need not exist.
Metric number_if(bool exists, const char* name, const char* unit, const char* meaning, double value) {
  return number(name, unit, meaning, exists ? std::optional(value) : std::nullopt);
}

/// A count that need not exist.
Metric count_if(bool exists, const char* name, const char* meaning, std::uint64_t value) {
  return {name, "1", meaning, exists ? Metric::Value(value) : Metric::Value()};
}

Metric count(const char* name, const char* meaning, std::uint64_t value) {
  return count_if(true, name, meaning, value);
}

MetricList metric_list(const TrajectoryErrors& e) {
  const bool any = e.rows > 0;
  return {
      count(
          "rows",
          "recorded rows at whose tilt the ideal trajectory exists, of a hand below 2 N (gentle) or from 2 N on (firm)",
          e.rows),
      number_if(any, "height_error_mean_m", "m", "mean of tip height - ideal height; negative: sunk in", e.height_mean),
      number_if(any, "height_error_rms_m", "m", "root mean square of tip height - ideal height", e.height_rms),
      number_if(any, "height_error_min_m", "m", "least tip height - ideal height", e.height_min),
      number_if(any, "height_error_max_m", "m", "largest tip height - ideal height", e.height_max),
      number_if(any, "lateral_error_mean_m", "m", "mean of lateral place of the tip - ideal one, towards the lean",
                e.lateral_mean),
      number_if(any, "lateral_error_rms_m", "m", "root mean square of lateral place of the tip - ideal one",
                e.lateral_rms),
      number_if(any, "lateral_error_max_m", "m", "largest |lateral place of the tip - ideal one|", e.lateral_max_abs),
      number_if(any, "interpenetration_mean_m", "m", "mean true depth of the tool in the exact block",
                e.interpenetration_mean),
      number_if(any, "interpenetration_max_m", "m", "largest true depth of the tool in the exact block",
                e.interpenetration_max)};
}

MetricList metric_list(const SubjectMean& m, const char* unit, const char* meaning) {
  const bool any = m.subjects > 0;
  return {number_if(any, "mean", unit, meaning, m.mean),
          number_if(any, "standard_error", unit, "standard error of that mean, over subjects", m.standard_error),
          count("subjects", "subjects that have a value", m.subjects)};
}

/// Forces of landing and of settled contact (contact_forces.hpp).
MetricList metric_list(const ContactForces& c) {
  return {
      count("landings",
            "first touches: rows in contact after at least metrics.settling_s without contact, or since the start",
            c.landings),
      number("landing_force_max_N", "N",
             "largest ||f|| within metrics.settling_s after a first touch, or before metrics.from_s", c.landing_max()),
      number("landing_force_step_max_N", "N", "largest ||f_k - f_(k-1)|| of those rows", c.landing_step_max()),
      number("settled_s", "s",
             "time in settled contact: rows in contact that belong to no landing, times the time step; below 1/30 s, a "
             "period of the high-pass, the metrics of settled contact have no value",
             c.settled),
      number("force_mean_in_contact_N", "N", "mean ||f|| of the rows in settled contact", c.mean()),
      number("settled_force_max_N", "N", "largest ||f|| of the rows in settled contact", c.max()),
      number("force_step_p99_N", "N",
             "99 % of the rows in settled contact have at most this force step ||f_k - f_(k-1)||; within 0.8 %",
             c.step_p99()),
      number("settled_force_step_max_N", "N", "largest force step ||f_k - f_(k-1)|| of the rows in settled contact",
             c.step_max()),
      number(
          "force_rms_above_30Hz_N", "N",
          "vibration of the force, which the hand feels: root mean square of f behind a high-pass (Butterworth, "
          "fourth order, 30 Hz, started at rest at the end of each landing) over the rows in settled contact; none at "
          "sampling rates of 60 Hz or less",
          c.rms_above_cutoff()),
      number("force_reversals_per_s", "1/s",
             "rows in settled contact whose f has a negative inner product with that of the row before, per settled_s",
             c.reversals_per_second())};
}

MetricList metric_list(const std::optional<ReductionJumps>& given) {
  const ReductionJumps jumps = given.value_or(ReductionJumps{});
  return {count_if(given.has_value(), "reduction_changes",
                   "rows in contact whose set of kept points is another than in the row before, in contact too; with "
                   "rendering.reduction",
                   jumps.changes),
          number("reduction_force_step_max_N", "N",
                 "largest force step ||f_k - f_(k-1)|| of such rows in settled contact; with rendering.reduction",
                 jumps.step_max())};
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

std::string cell_text(const Metric::Value& value) {
  if (const auto* count = std::get_if<std::uint64_t>(&value)) return std::to_string(*count);
  const auto* number = std::get_if<double>(&value);
  return number != nullptr ? std::string(NumberText(*number)) : "";
}

void append(MetricList& list, std::string_view section, const MetricList& more) {
  const std::string prefix = section.empty() ? "" : std::string(section) + ".";
  for (const Metric& metric : more) list.push_back({prefix + metric.name, metric.unit, metric.meaning, metric.value});
}

MetricList metric_list(const Metrics& m) {
  const bool any = m.rows > 0;
  const auto ratio = m.ratio.value_or(RatioRange{});
  const auto friction = m.explicit_friction.value_or(ExplicitFriction{});
  MetricList list = {
      number("force_max_N", "N", "largest ||f|| of a row", m.force_max),
      number("force_step_max_N", "N", "largest force step ||f_k - f_(k-1)||, landings included", m.force_step_max),
      number("velocity_total_variation_m_per_s", "m/s",
             "sum ||v_k - v_(k-1)|| over all rows: what a smooth motion has little of", m.velocity_total_variation),
      count("force_reversals", "rows whose f has a negative inner product with that of the row before",
            m.force_reversals),
      number(
          "vibration_power_above_30Hz_m2_per_s2", "m2/s2",
          "mean ||v||^2 of all rows behind a high-pass (Butterworth, fourth order, 30 Hz); none at sampling rates of "
          "60 Hz or less",
          m.vibration_power),
      number("depth_max_m", "m", "largest penetration depth of a colliding point", m.depth_max),
      number_if(m.ratio.has_value(), "ratio_min", "1",
                "smallest stiffness ratio rho = u^T S u of a rendered contact: the combined stiffness along it, in "
                "units of K",
                ratio.min),
      number_if(m.ratio.has_value(), "ratio_max", "1", "largest such ratio", ratio.max),
      number_if(any, "colliding_mean", "1", "colliding points per row, rows without contact included",
                m.colliding_mean),
      count("colliding_max", "most colliding points of a row", m.colliding_max),
      number_if(any, "rendered_mean", "1",
                "points that the force law saw (after local average and reduction) per row, rows without contact "
                "included",
                m.rendered_mean),
      count("rendered_max", "most points that the force law saw in a row", m.rendered_max),
      count("steps_in_contact", "rows with a colliding point", m.steps_in_contact),
      number_if(any, "contact_share", "1", "steps_in_contact / steps",
                static_cast<double>(m.steps_in_contact) / static_cast<double>(m.rows)),
      number("last_contact_s", "s", "time of the last row with a colliding point", m.last_contact),
      number("speed_max_m_per_s", "m/s", "largest speed of the tip's centre", m.speed_max),
      number_if(m.explicit_friction.has_value(), "explicit_friction_limit_N", "N",
                "largest ||f_spring|| whose friction the explicit integrator steps stably, (B_max - mu_s) / mu_f",
                friction.limit),
      count_if(m.explicit_friction.has_value(), "explicit_friction_rows_beyond", "rows with a larger ||f_spring||",
               friction.rows_beyond),
      count_if(friction.first_step.has_value(), "explicit_friction_first_step", "the first of those rows",
               friction.first_step.value_or(0))};
  append(list, "", metric_list(m.contact));
  append(list, "", metric_list(m.reduction));
  return list;
}

MetricList final_position_list(const Metrics& m) {
  const bool any = m.rows > 0;
  return {number_if(any, "final_position_m.x", "m", "x of the tip's centre in the last row", m.final_position.x()),
          number_if(any, "final_position_m.y", "m", "y of the tip's centre in the last row", m.final_position.y()),
          number_if(any, "final_position_m.z", "m", "z of the tip's centre in the last row", m.final_position.z())};
}

MetricList metric_list(const std::optional<PassivityMetrics>& m) {
  const bool any = m.has_value();
  const PassivityMetrics p = m.value_or(PassivityMetrics{});
  return {number_if(any, "energy_min_J", "J",
                    "least observed energy of a row: what translation and rotation have put into the rendering; "
                    "negative when it gave more than it had",
                    p.energy_min),
          number_if(any, "time_of_min_s", "s", "time of the first row that has it", p.time_of_min),
          number_if(any, "energy_end_J", "J", "observed energy of the last row", p.energy_end),
          number_if(any, "net_created_J", "J", "energy that the rendering created, max(0, -energy_min_J)",
                    p.net_created())};
}

MetricList metric_list(const EnergyMetrics& m) {
  const EnergyBalance& b = m.balance;
  return {number("created_sum_J", "J", "sum of created energy over the steps that created some", m.created_sum),
          number("created_max_J", "J", "most energy that a single step created", m.created_max),
          number("created_J", "J",
                 "what the springs store at the end beyond the work that translation and rotation did on them: made by "
                 "contacts that appear, vanish or change their weights",
                 b.created),
          number("input_J", "J", "work of f_in on the tool", b.input),
          number("spring_J", "J", "work of f_spring on the tool", b.spring),
          number("damping_J", "J", "work of damping, friction and force limit: of f - f_spring", b.damping),
          number("rotation_J", "J", "what the tool's turning put into the springs", b.rotation),
          number("integration_J", "J", "energy made by the integrator", b.integration),
          number("script_J", "J", "work of a prescribed motion", b.script),
          number("hand_J", "J", "work of the hand on the handle", b.hand),
          number("actuator_J", "J", "work of the device's actuators", b.actuator),
          number("residual_max_J", "J", "largest |kinetic energy that the terms do not explain| of a row: rounding",
                 m.residual_max)};
}

MetricList metric_list(const IdealTrajectoryMetrics& m) {
  MetricList list;
  append(list, "gentle", metric_list(m.gentle));
  append(list, "firm", metric_list(m.firm));
  list.push_back(count("rows_without_ideal", "recorded rows at whose tilt the ideal trajectory does not exist",
                       m.rows_without_ideal));
  return list;
}

MetricList metric_list(const ForceFidelity& f) {
  const bool any = f.rows > 0;
  return {count("rows", "rows that have a reference force f_m: measured with the stroke, or ideal", f.rows),
          number_if(any, "reference_force_rms_N", "N", "root mean square of ||f_m||", f.reference_rms),
          number_if(any, "force_error_rms_N", "N", "root mean square of ||f - f_m||", f.error_rms),
          number("force_error_relative", "1", "force_error_rms_N / reference_force_rms_N", f.relative()),
          number_if(
              any, "force_error_normal_rms_N", "N",
              "root mean square of n n^T (f - f_m); n is f_spring / ||f_spring||, what is rendered before damping and "
              "friction, or where nothing is rendered f_m / ||f_m||",
              f.normal_rms),
          number_if(any, "force_error_tangential_rms_N", "N",
                    "root mean square of (I - n n^T) (f - f_m), with the same n", f.tangential_rms),
          number("force_artefact_share", "1",
                 "root mean square of the part of f across f_m, all of it where f_m is zero, over that of ||f||",
                 f.artefact_share()),
          count("direction_rows", "rows in which ||f|| and ||f_m|| are both above 0.1 N", f.direction_rows),
          number_if(f.direction_rows > 0, "force_direction_error_rad", "rad",
                    "mean angle between f and f_m of those rows", f.direction_error),
          number("force_lag_s", "s",
                 "time by which f follows f_m: where their correlation (Pearson's, all components) is greatest, within "
                 "0.1 s; none where it is not or where a force does not vary",
                 f.lag)};
}

MetricList metric_list(const LostTorqueMetrics& m) {
  return {
      number_if(m.rows_in_contact > 0, "lost_mean_Nm", "Nm",
                "mean ||tau|| of the rows in contact; tau = sum r_i x f_i about the tip's centre is the torque that "
                "the rendered contacts would exert by their shares f_i of f_spring, and that is lost",
                m.mean),
      number_if(m.rows_in_contact > 0, "lost_max_Nm", "Nm", "largest ||tau|| of a row", m.max)};
}

MetricList metric_list(const PerceptionMetrics& m) {
  const auto share = [](std::uint64_t part, std::uint64_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
  };
  const double rms = m.acceleration_rms.value_or(0.0);
  return {
      number_if(m.reference_rows > 0, "error_noticed_share", "1",
                "share of the rows with a reference force f_m whose ||f - f_m|| is above the just noticeable "
                "difference: perception.force_jnd of ||f_m||, or of perception.least_force_N where that is more",
                share(m.error_rows, m.reference_rows)),
      number_if(m.rows_in_contact > 0, "vibration_noticed_share", "1",
                "share of the rows in contact whose force above 30 Hz (Butterworth, fourth order) is above the just "
                "noticeable difference of the rest of the force",
                share(m.vibration_rows, m.rows_in_contact)),
      number("tactile_acceleration_rms_m_per_s2", "m/s2",
             "root mean square of the handle's acceleration between perception.band_Hz, where touch is most sensitive",
             m.acceleration_rms),
      number_if(m.acceleration_rms && m.threshold_rms > 0.0, "tactile_acceleration_over_threshold", "1",
                "the same over that of a vibration that is just felt, of perception.amplitude_at_250Hz_m; above 1 it "
                "is felt",
                rms / m.threshold_rms)};
}

MetricList metric_list(const std::vector<PlaceMetrics>& places) {
  MetricList list;
  for (const PlaceMetrics& place : places) {
    const std::string section = std::to_string(place.place);
    append(list, section + ".success_rate",
           metric_list(place.success_rate, "1",
                       "share of the targets at this place that were removed, mean over subjects"));
    append(list, section + ".completion_time_s",
           metric_list(place.completion_time, "s",
                       "time until a target at this place was removed or the limit was reached, mean over subjects"));
    append(list, section + ".model_force_N",
           metric_list(place.model_force, "N", "mean ||f|| of the rows on a target at this place, mean over subjects"));
    append(list, section + ".speed_m_per_s",
           metric_list(place.speed, "m/s",
                       "mean speed of the handle in the rows on a target at this place, mean over subjects"));
  }
  return list;
}

}  // namespace hapbench
