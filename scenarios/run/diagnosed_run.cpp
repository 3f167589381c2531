#include "scenarios/run/diagnosed_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/stages/damping_and_limits.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/impedance_device.hpp"
#include "results/observe/contact_forces.hpp"
#include "scenarios/input/rounding.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/linear_contact.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/run/vibration_frequency.hpp"
#include "scenarios/run/vibration_limit.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

/// Smallest number of steps in the last quarter from which the drift is computed.
constexpr std::uint64_t kMinQuarterSteps = 10;
/// Number of time steps after a change of the measured position in which the output of the velocity filter is
/// evaluated. A filter that has not reached its peak within this number passes almost nothing.
constexpr int kFilterSamples = 100;
/// Smallest stiffness of the search for the linear limit, in units of K.
constexpr double kSmallestStiffness = 1e-9;
/// A loop whose largest stable stiffness is at most this fraction of K counts as unstable at any stiffness: nothing
/// could be felt. The fraction is far above the rounding errors of the eigenvalues, which alone make a loop without
/// damping stable up to about 1e-10 m / dt^2, with the mass m.
constexpr double kNegligibleStiffness = 1e-4;

/// Returns the largest stable K [N/m] of a tool on permanent springs. The springs have the largest stiffness ratio
/// lambda of the run. Empty without a linear loop.
Number springs_limit(const DiagnosedRun& run, const Scenario& scenario) {
  const Number lambda = run.metric("ratio_max");
  const double K = scenario.rendering.stiffness;
  if (!lambda || !(*lambda > 0.0) || contact_step_matrix(scenario, *lambda).size() == 0) return std::nullopt;
  constexpr double kMax = 2.0;  // upper end of the search range, in units of K; a limit above it is not relevant
  Number smallest;
  for (Scenario& at : with_each_subject(scenario)) {
    const double limit = first_stability_limit(kSmallestStiffness * K, kMax * K, [&](double stiffness) {
      at.rendering.stiffness = stiffness;
      return contact_step_matrix(at, *lambda);
    });
    smallest = std::min(smallest.value_or(limit), limit);
  }
  return smallest;
}

/// Returns the largest K [N/m] at which the linear loop is stable, with the contact linearised near the last step in
/// contact. Empty without contact or without a linear loop.
Number surface_limit(const DiagnosedRun& run, const LoadedScenario& loaded) {
  if (!run.observations.last_contact || has_multi_rate_contacts(loaded.scenario)) return std::nullopt;
  const CheckedScenario scenario = checked(loaded);
  const bool is_of_run = &loaded == &run.loaded && run.shell;
  const auto shell = is_of_run ? run.shell : make_shell(scenario.scenario(), scenario.files());
  return linear_stiffness_limit(scenario, shell, *run.observations.last_contact);
}

/// Returns K divided by the largest stable K of the linear loop in contact, rounded to six digits, so that builds with
/// different rounding errors give the same result. Returns 0 if the largest stable K is above 2 K, because the search
/// ends there. Empty if no limit of the loop is known, for example because the run has no contact. `loaded`: the
/// scenario of the run, or a variant of it.
Number ratio_to_stability_limit(const DiagnosedRun& run, const LoadedScenario& loaded) {
  const double K = loaded.scenario.rendering.stiffness;
  if (!(K > 0.0) || !run.is_free()) return std::nullopt;
  // Without a hand, a tool has no equilibrium on a surface. The derivative of the force at a pose that is no
  // equilibrium contains the change of the normal, which pushes the tool sideways at any K. Without an equilibrium,
  // therefore use the limit of a tool on permanent springs.
  const bool has_equilibrium = !run.has_springs() && run.has_hand();
  const Number limit = has_equilibrium ? surface_limit(run, loaded) : springs_limit(run, loaded.scenario);
  if (!limit) return std::nullopt;
  return rounded_to_digits(K / std::max(kSmallestStiffness * K, *limit), 6);
}

/// Returns true if the run shows a sign of an unstable loop: it vibrates, diverges, loses contact or passes through the
/// surface. Returns false if a force law or a contact module reported a fault, because the loop is then not the cause.
bool looks_unstable(const DiagnosedRun& run) {
  if (!run.result.end.divergence.fault.empty()) return false;
  return run.ended(Outcome::diverges, Outcome::lost_contact, Outcome::went_through) || run.vibrates() ||
         buzz(run).value_or(0.0) > kMaxBuzz || shake(run).value_or(0.0) > kMaxShake;
}

/// Returns ratio_to_stability_limit() if looks_unstable(run) is true, else an empty value.
Number ratio_in_vibration(const DiagnosedRun& run) {
  if (!looks_unstable(run)) return std::nullopt;
  if (!run.ratio_to_limit) run.ratio_to_limit = ratio_to_stability_limit(run, run.loaded);
  return *run.ratio_to_limit;
}

bool is_unstable_at_any_stiffness(double ratio) {
  return ratio >= 1.0 / kNegligibleStiffness;
}

}  // namespace

Number quotient(const Number& a, const Number& b) {
  return a && b && *b > 0.0 ? Number(*a / *b) : std::nullopt;
}

Number DiagnosedRun::of_mean_force(const char* name) const {
  const bool is_pressed = !is_free() || has_hand() || has_springs();
  return is_pressed ? quotient(metric(name), metric("force_mean_in_contact_N")) : std::nullopt;
}

bool DiagnosedRun::vibrates() const {
  return metric("vibration_last_quarter_m_per_s").value_or(0.0) > kMaxVibration;
}

Number DiagnosedRun::if_completed(const Number& number) const {
  if (has_springs() && !vibrates()) return std::nullopt;
  return ended(Outcome::diverges, Outcome::went_through, Outcome::no_contact) ? std::nullopt : number;
}

Number fault(const DiagnosedRun& run) {
  return run.ended(Outcome::diverges) && is_fault(run.result.end.divergence) ? Number(1.0) : std::nullopt;
}

Number diverged(const DiagnosedRun& run) {
  return fault(run) ? std::nullopt : ended<Outcome::diverges>(run);
}

Number measured_force_angle(const DiagnosedRun& run) {
  constexpr double kMinRows = 10.0;
  const Number rows = run.metric("fidelity.direction_rows");
  const bool is_measured = !run.scenario().reference_force && rows && *rows >= kMinRows;
  return is_measured ? run.metric("fidelity.force_direction_error_rad") : std::nullopt;
}

Number longest_step(const DiagnosedRun& run) {
  // In a diverged run, long steps are a consequence of the divergence and not the cause.
  if (run.ended(Outcome::diverges)) return std::nullopt;
  return quotient(run.observations.longest_step, run.half_width());
}

bool step_exceeds_half_width(const DiagnosedRun& run) {
  return longest_step(run).value_or(0.0) > 1.0;
}

Number buzz(const DiagnosedRun& run) {
  return run.if_completed(run.of_mean_force("force_rms_above_30Hz_N"));
}

Number pop(const DiagnosedRun& run) {
  return run.if_completed(run.of_mean_force("settled_force_step_max_N"));
}

Number shake(const DiagnosedRun& run) {
  const Number power = run.metric("vibration_power_above_30Hz_m2_per_s2");
  if (run.has_springs() || !run.is_free() || run.of_mean_force("force_rms_above_30Hz_N") || !power) return std::nullopt;
  return run.if_completed(std::sqrt(*power));
}

Number chatter(const DiagnosedRun& run) {
  // If nothing presses the tool, the force reverses whenever the tool moves from one wall to another.
  const bool is_pressed = !run.is_free() || run.has_hand() || run.has_springs();
  return is_pressed ? run.if_completed(run.metric("force_reversals_per_s")) : std::nullopt;
}

Number stability_limit_ratio(const DiagnosedRun& run) {
  const Number ratio = ratio_in_vibration(run);
  return ratio && !is_unstable_at_any_stiffness(*ratio) && !unstable_alone(run) ? ratio : std::nullopt;
}

Number unstable_alone(const DiagnosedRun& run) {
  if (!run.is_free() || !looks_unstable(run)) return std::nullopt;
  return unstable_without_wall(run.scenario()).empty() ? Number(std::nullopt) : Number(1.0);
}

Number unstable_loop(const DiagnosedRun& run) {
  const Number ratio = ratio_in_vibration(run);
  return ratio && is_unstable_at_any_stiffness(*ratio) && !unstable_alone(run) ? Number(1.0) : std::nullopt;
}

/// Returns ratio_to_stability_limit() after a change of the scenario; empty if the changed loop is unstable without
/// contact.
static Number ratio_after(const DiagnosedRun& run, const std::function<void(Scenario&)>& change) {
  LoadedScenario changed = run.loaded;
  change(changed.scenario);
  return unstable_without_wall(changed.scenario).empty() ? ratio_to_stability_limit(run, changed) : std::nullopt;
}

bool is_stable_at_some_stiffness(const DiagnosedRun& run, const std::function<void(Scenario&)>& change) {
  const Number ratio = ratio_after(run, change);
  return ratio && !is_unstable_at_any_stiffness(*ratio);
}

bool is_below_limit(const DiagnosedRun& run, const std::function<void(Scenario&)>& change) {
  const Number ratio = ratio_after(run, change);
  return ratio && *ratio <= kMaxLimitRatio;
}

/// Returns the frequency of the vibration [Hz]: oscillation_frequency() of the rendered force in the last quarter.
/// Empty if there is no such frequency, or if it is at most kVibrationCutoff.
static Number vibration_frequency(const DiagnosedRun& run) {
  if (!run.frequency) {
    run.frequency = oscillation_frequency(run.observations.last_forces, run.scenario().time.step);
    if (run.frequency->value_or(0.0) <= kVibrationCutoff) run.frequency->reset();
  }
  return *run.frequency;
}

Number scripted_vibration(const DiagnosedRun& run) {
  // Relative difference of frequencies that count as equal: the resolution of a few periods in the last quarter.
  constexpr double kSameFrequency = 0.03;
  const Number frequency = vibration_frequency(run);
  if (!frequency) return std::nullopt;
  for (const double period : script_periods(run.scenario()))
    for (const double harmonic : {1.0, 2.0, 3.0})
      if (std::abs(*frequency * period / harmonic - 1.0) <= kSameFrequency) return frequency;
  return std::nullopt;
}

bool left_surface_long_ago(const DiagnosedRun& run) {
  const Number last = run.metric("last_contact_s");
  return last && *last < 0.5 * run.result.duration;
}

Number coarseness(const DiagnosedRun& run) {
  // kSufficientContacts: number of contacts in a step that gives a smooth force. kMinSpacings: shortest path in contact
  // for which coarseness() has a value, in units of the point spacing.
  constexpr double kSufficientContacts = 4.0, kMinSpacings = 10.0;
  const auto distance = point_distance(run.loaded);
  const Number contacts = quotient(run.metric("colliding_mean"), run.metric("contact_share"));
  // Contacts from a module or a recording do not depend on the spacing of the point shell.
  if (!distance || !contacts || has_external_contacts(run.scenario()) ||
      run.observations.path_in_contact < kMinSpacings * distance->metres)
    return std::nullopt;
  const double factor = kSufficientContacts / *contacts;
  const bool is_outline = std::holds_alternative<Hole2d>(run.scenario().environment);
  return run.if_completed(is_outline ? factor : std::sqrt(factor));
}

/// Returns the damping that the law renders along its stiffest direction [N s/m], with its upper limit.
static double rendered_damping(const DiagnosedRun& run) {
  const RenderingConfig& rendering = run.scenario().rendering;
  const double B = run.metric("ratio_max").value_or(1.0) * normal_damping(rendering);
  return rendering.max_damping ? std::min(B, *rendering.max_damping) : B;
}

Number encoder_force(const DiagnosedRun& run) {
  const ImpedanceDeviceConfig* device = run.impedance();
  const bool is_rough = buzz(run).value_or(0.0) > kMaxBuzz || pop(run).value_or(0.0) > kMaxBuzz ||
                        chatter(run).value_or(0.0) > kMaxChatter || run.vibrates();
  if (device == nullptr || !is_rough || run.scenario().rendering.hunt_crossley) return std::nullopt;
  VelocityFilter filter(device->velocity_filter, run.scenario().time.step);
  filter.reset(Vec3::Zero());
  double fastest = 0.0;
  for (int i = 0; i < kFilterSamples; ++i)
    fastest = std::max(fastest, filter.read(Vec3(device->encoder_step, 0.0, 0.0)).x());
  const Number mean = run.metric("force_mean_in_contact_N");
  return quotient(rendered_damping(run) * fastest, mean);
}

Number position_noise_force(const DiagnosedRun& run) {
  const ImpedanceDeviceConfig* device = run.impedance();
  if (device == nullptr) return std::nullopt;
  // The variance of filtered white noise is the variance of the noise times the sum of the squared response to an
  // impulse.
  VelocityFilter filter(device->velocity_filter, run.scenario().time.step);
  filter.reset(Vec3::Zero());
  double squares = 0.0;
  for (int i = 0; i < kFilterSamples; ++i) {
    const double velocity = filter.read(Vec3(i == 0 ? device->position_noise : 0.0, 0.0, 0.0)).x();
    squares += velocity * velocity;
  }
  return run.scenario().rendering.hunt_crossley ? 0.0 : rendered_damping(run) * std::sqrt(squares);
}

Number sensor_noise_force(const DiagnosedRun& run) {
  const Scenario& s = run.scenario();
  const auto* device = std::get_if<AdmittanceDeviceConfig>(&s.device);
  if (device == nullptr) return std::nullopt;
  // White noise w with the spectral density S = noise^2 dt in M x'' + B x' + K x = w gives K x the variance S K / (2 B)
  // and B x' the variance S B / (2 M). With little damping, the variance of K x is still S K t / (2 M) after a time t.
  const double M = s.rendering.mass, B = normal_damping(s.rendering);
  const double density = device->sensor.noise * device->sensor.noise * s.time.step;
  const double decay = B > 0.0 ? std::min(M / B, run.result.duration) : run.result.duration;
  return std::sqrt(density * (s.rendering.stiffness * decay + B) / (2.0 * M));
}

bool noise_explains_vibration(const DiagnosedRun& run, const Number& force) {
  constexpr double kShare = 0.5;
  const Number measured = run.metric("force_rms_above_30Hz_N");
  return force && measured && *force > 0.0 && *force >= kShare * *measured;
}

/// Returns true if the energy that the motors of the device gave was observed.
static bool observes_motors(const DiagnosedRun& run) {
  return run.tool != nullptr && run.observations.created_by_motors;
}

Number created_energy(const DiagnosedRun& run) {
  const Number rendered = run.metric("passivity.net_created_J");
  return run.if_completed(rendered && observes_motors(run) ? run.observations.created_by_motors : rendered);
}

std::string created_by(const DiagnosedRun& run) {
  return observes_motors(run) ? " by the force of the motors, with the delay and the limits of the device"
                              : " by the rendered force";
}

bool stiffer_hand_helps(const DiagnosedRun& run) {
  const RunObservations& rows = run.observations;
  const auto& friction = run.scenario().rendering.dry_friction;
  if (!friction || rows.last_spring.isZero(0.0) || spring_of(run.scenario().hand) == nullptr) return true;
  const Vec3 normal = rows.last_spring.normalized();
  const double along_normal = rows.last_hand_force.dot(normal);
  return (rows.last_hand_force - along_normal * normal).norm() > friction->mu * std::abs(along_normal);
}

Number damping_share(const DiagnosedRun& run) {
  const Scenario& s = run.scenario();
  const ImpedanceDeviceConfig* device = run.impedance();
  // Hunt and Crossley's damping replaces B and grows with the depth. Delays, filters and a transmission lower the
  // largest stable damping; the rule "loop" covers them.
  if (!run.metric("ratio_max") || !run.is_free() || s.rendering.hunt_crossley) return std::nullopt;
  if (device != nullptr && (device->delay_samples > 0.0 || device->transmission || device->position_filter ||
                            !std::holds_alternative<DifferenceFilter>(device->velocity_filter)))
    return std::nullopt;
  const double B = rendered_damping(run);
  double mass = device != nullptr ? device->handle_mass : s.rendering.mass;
  // A passive hand is fixed to the handle.
  if (const auto* hand = std::get_if<MassSpringDamperHandFields>(&s.hand)) mass += hand->mass;
  return B * s.time.step / mass / (device != nullptr ? 2.0 : s.integrator.type->damper_limit);
}

Number drift(const DiagnosedRun& run) {
  const RunObservations& rows = run.observations;
  const RunObservations::Quarter& last = rows.last_quarter;
  const HandFields& hand = run.scenario().hand;
  const bool is_constant =
      std::holds_alternative<ForceHandFields>(hand) || std::holds_alternative<PushHandFields>(hand);
  if (last.rows < kMinQuarterSteps || !last.always_in_contact || !is_constant || has_scripted_motion(run.scenario()) ||
      !run.is_free())
    return std::nullopt;
  // Remove the component along the force.
  const Vec3 push = rows.last_force.normalized(), motion = rows.tip - last.start;
  return run.if_completed(quotient((motion - motion.dot(push) * push).norm(), run.half_width()));
}

Number depth_in_half_widths(const DiagnosedRun& run) {
  return run.if_completed(quotient(run.metric("inside_settled_m"), run.half_width()));
}

Number softness(const DiagnosedRun& run) {
  // Along some contact, the rendered stiffness may be 0 or a rounding error. No larger factor is reported.
  constexpr double kMaxSoftnessReported = 1e9;
  const Number ratio = run.metric("ratio_min");
  return ratio ? Number(1.0 / std::max(*ratio, 1.0 / kMaxSoftnessReported)) : std::nullopt;
}

Number saturation(const DiagnosedRun& run) {
  return quotient(static_cast<double>(run.observations.at_force_limit),
                  static_cast<double>(run.observations.in_contact));
}

Number inward_share(const DiagnosedRun& run) {
  const auto& inward = run.observations.inward;
  if (!inward) return std::nullopt;
  return quotient(static_cast<double>(*inward), static_cast<double>(run.observations.in_contact));
}

Number bounces(const DiagnosedRun& run) {
  const Number landings = run.metric("landings"), lifts = scripted_lifts(run.scenario());
  if (!landings || !lifts || !run.is_free()) return std::nullopt;
  return quotient(std::max(*landings - 1.0 - *lifts, 0.0), run.result.duration);
}

std::string buzz_frequency(const DiagnosedRun& run) {
  const Number frequency = vibration_frequency(run);
  return frequency ? fmt::format("; the frequency is about {:.0f} Hz", *frequency) : "";
}

}  // namespace hapbench
