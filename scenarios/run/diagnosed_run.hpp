#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "results/summary/summary.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

/// Computes the numbers that the rules of the diagnosis compare with their thresholds, from a finished run. A number is
/// empty if it has no meaning for the run.
namespace hapbench {

using Number = std::optional<double>;

/// Returns a / b; empty if a number is missing or b is not positive.
Number quotient(const Number& a, const Number& b);

/// A finished run, with the quantities from which the numbers of the rules are computed.
struct DiagnosedRun {
  const LoadedScenario& loaded;
  const Result& result;
  const RunObservations& observations;
  const ToolShape* tool;  ///< null if only rules that need no tool (rules on metrics) are evaluated
  std::shared_ptr<const PointShell> shell = {};  ///< point shell of the run; null: made anew where a rule needs it
  /// Cache of K divided by the linear stability limit, which several rules need and which takes a few milliseconds.
  /// Empty until the ratio has been computed.
  mutable std::optional<Number> ratio_to_limit = {};
  /// Cache of the frequency of the vibration [Hz], which several rules need and which takes a few milliseconds. Empty
  /// until the frequency has been computed.
  mutable std::optional<Number> frequency = {};

  const Scenario& scenario() const { return loaded.scenario; }
  template <class... Outcomes>
  bool ended(Outcomes... outcomes) const {
    return ((result.end.outcome == outcomes) || ...);
  }
  /// Returns a metric's value; empty if the run does not have the metric or it has no value.
  Number metric(std::string_view name) const { return number_of(result.metrics, name); }
  bool has_warning(std::string_view kind) const {
    return std::ranges::find(result.warnings, kind, &Warning::kind) != result.warnings.end();
  }
  bool is_free() const { return position_is_free(scenario().motion); }
  bool has_springs() const { return std::holds_alternative<SpringsEnvironment>(scenario().environment); }
  bool has_hand() const { return !std::holds_alternative<NoHandFields>(scenario().hand); }
  /// Returns the impedance device; null for other devices.
  const ImpedanceDeviceConfig* impedance() const { return std::get_if<ImpedanceDeviceConfig>(&scenario().device); }
  /// Returns a metric divided by the mean force in settled contact. Empty if there was no settled contact, or if
  /// nothing presses the tool. Without a pressing force, the mean force results only from friction, and is no reference
  /// for vibration.
  Number of_mean_force(const char* name) const;
  Number half_width() const { return has_springs() || tool == nullptr ? std::nullopt : Number(tool->half_width()); }
  /// Returns true if the tool vibrates in the last quarter of the run.
  bool vibrates() const;
  /// Returns `number` if it is meaningful for this run, else an empty value. A number is not meaningful in a run that
  /// diverged, went through the surface or never touched the surface. A number is also not meaningful for a tool on
  /// springs that does not vibrate: such a tool comes to rest, and its mean force tends to zero.
  Number if_completed(const Number& number) const;
};

/// Returns 1 if the run ended with one of `outcomes` and the scenario does not expect this outcome; otherwise an empty
/// value. An expected outcome is no problem and needs no advice.
template <Outcome... outcomes>
Number ended(const DiagnosedRun& run) {
  const bool is_expected = outcome_is_expected(run.scenario().expect, run.result.end.outcome);
  return run.ended(outcomes...) && !is_expected ? Number(1.0) : std::nullopt;
}

/// Thresholds of rules that other rules or the advice also use. The table of the rules in diagnosis.cpp describes the
/// number that each threshold bounds. kMaxChatter is in 1/s and kMaxCreatedEnergy in J; all other thresholds are pure
/// numbers.
inline constexpr double kMaxBuzz = 0.1, kMaxLimitRatio = 0.8, kMaxEncoderForce = 0.1, kMaxReduction = 0.1,
                        kMaxChatter = 10.0, kMaxDampingShare = 0.5, kMaxSoftness = 3.0, kMaxCoarseness = 1.15,
                        kMaxSaturation = 0.01, kMaxInward = 0.5, kMaxCreatedEnergy = 1e-3;
/// Threshold for shake() [m/s]. It is ten times kMaxVibration, because shake() includes the landing: a landing at speed
/// v contributes v sqrt(2.6 ms / duration of the run).
inline constexpr double kMaxShake = 1e-2;

/// Returns 1 if the run ended because a force law or a module failed, or because a force was not finite; otherwise an
/// empty value.
Number fault(const DiagnosedRun& run);
/// Returns 1 if the run left its bounds although all numbers were finite, and the scene does not expect this; otherwise
/// an empty value.
Number diverged(const DiagnosedRun& run);
/// Returns the mean angle [rad] between the rendered force and the force that was measured with the stroke; empty if
/// fewer than 10 steps have both forces, or if the scenario defines another reference force.
Number measured_force_angle(const DiagnosedRun& run);
Number longest_step(const DiagnosedRun& run);
bool step_exceeds_half_width(const DiagnosedRun& run);
Number buzz(const DiagnosedRun& run);
Number pop(const DiagnosedRun& run);
/// Returns the rms of the tool's velocity above 30 Hz over all steps [m/s]. This number replaces buzz() for a tool that
/// moves freely and has no settled contact or no pressing hand. Empty in three cases: there is a mean force in settled
/// contact to which buzz() can refer, a script moves the tool, or the environment consists of springs.
Number shake(const DiagnosedRun& run);
Number chatter(const DiagnosedRun& run);
/// Returns K divided by the largest stable K of the linear loop in contact, rounded to six digits. Has a value only if
/// the run diverged, lost contact, went through the surface or vibrates, the run has a linear loop, this loop is stable
/// at some K (unstable_loop() is empty), and unstable_alone() is empty.
Number stability_limit_ratio(const DiagnosedRun& run);
/// Returns 1 if the run diverged, lost contact, went through the surface or vibrates, the tool moves freely, and the
/// loop of hand and device is unstable even without contact, by its eigenvalues; otherwise an empty value.
Number unstable_alone(const DiagnosedRun& run);
/// Returns 1 if the run diverged, lost contact, went through the surface or vibrates, the linear loop with a contact is
/// unstable even with a stiffness of K / 10000, and unstable_alone() is empty; otherwise an empty value.
Number unstable_loop(const DiagnosedRun& run);
/// Returns true if the linear loop with a contact is stable at some stiffness of at least K / 10000 after `change`.
bool is_stable_at_some_stiffness(const DiagnosedRun& run, const std::function<void(Scenario&)>& change);
/// Returns true if K is at most kMaxLimitRatio times the largest stable K of the linear loop after `change`.
bool is_below_limit(const DiagnosedRun& run, const std::function<void(Scenario&)>& change);
/// Returns the frequency [Hz] of the force in the last quarter, if it is the frequency of a periodic script of hand or
/// tool, or twice or three times this frequency; otherwise an empty value.
Number scripted_vibration(const DiagnosedRun& run);
/// Returns true if the tool had no contact in the second half of the run.
bool left_surface_long_ago(const DiagnosedRun& run);
/// Returns the point spacing divided by the spacing at which four points would be in contact. The number of contacts is
/// proportional to 1 / spacing^2 on a surface, and to 1 / spacing on the outline of a planar hole. Empty if the path of
/// the tip along the surface is shorter than ten spacings, or if the contacts come from a recording or a module.
Number coarseness(const DiagnosedRun& run);
/// Returns the largest damping force that one encoder increment causes, divided by the mean force in contact. Empty in
/// three cases: the device is no impedance device, the damping is Hunt-Crossley damping, or no vibration, force step or
/// force reversal exceeds its threshold.
Number encoder_force(const DiagnosedRun& run);
/// Returns the rms of the force [N] that the noise of the measured position causes through the rendered damping. Empty
/// unless the device is an impedance device; 0 without noise and for Hunt-Crossley damping.
Number position_noise_force(const DiagnosedRun& run);
/// Returns the rms of the rendered force [N] that the noise of the force sensor of an admittance device causes: white
/// noise moves a virtual mass on a contact with K and B. Empty for other devices.
Number sensor_noise_force(const DiagnosedRun& run);
/// Returns true if the noise causes at least half of the measured rms of the force above 30 Hz. `force`: rms of the
/// force that the noise causes [N].
bool noise_explains_vibration(const DiagnosedRun& run, const Number& force);
/// Returns the net energy that the rendering created [J]. On an impedance device, this is the energy that the motors
/// gave (RunObservations::created_by_motors). Without observations, returns the metric passivity.net_created_J.
Number created_energy(const DiagnosedRun& run);
/// Returns the force whose energy created_energy() is, as text.
std::string created_by(const DiagnosedRun& run);
/// Returns true if a stiffer hand could move a tool that dry friction holds. A hand whose spring acts in all directions
/// presses harder if it is stiffer. It helps only if its force along the surface exceeds mu times its force along the
/// normal.
bool stiffer_hand_helps(const DiagnosedRun& run);
/// Returns B dt / m divided by the largest value of B dt / m at which a step is stable. B is the damping along the
/// stiffest contact, dt the time step, and m the mass of the handle of an impedance device or otherwise of the tool.
/// The limit is 2 for a handle, and a property of the integrator for a tool. Empty for a device with a delay, a filter
/// other than the difference, or a transmission, which lower the limit.
Number damping_share(const DiagnosedRun& run);
/// Returns the displacement of the tip perpendicular to the force in the last quarter, divided by the tool's half
/// width. Empty unless three conditions hold: the tool moves freely, the hand force is constant, and the tool is in
/// contact in all steps of the last quarter.
Number drift(const DiagnosedRun& run);
Number depth_in_half_widths(const DiagnosedRun& run);
Number softness(const DiagnosedRun& run);
Number saturation(const DiagnosedRun& run);
/// Returns the fraction of the steps in contact in which the spring force of an external law points deeper into the
/// surface at every contact. Empty for a built-in law, for springs and without contact.
Number inward_share(const DiagnosedRun& run);
/// Returns the number of landings per second [1/s]. Does not count the first landing, nor one landing for each time at
/// which the hand's script may have lifted the tool (scripted_lifts()).
Number bounces(const DiagnosedRun& run);

/// Returns the frequency of the vibration in the last quarter as text; empty without a vibration.
std::string buzz_frequency(const DiagnosedRun& run);

}  // namespace hapbench
