#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "results/summary/summary.hpp"
#include "scenarios/run/diagnosis_observer.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "sim/tool/tool_shape.hpp"

/// A finished run, and the numbers that the rules of the diagnosis compare with their thresholds. A number is empty if
/// it has no meaning for the run.
namespace hapbench {

using Number = std::optional<double>;

/// Returns a / b; empty if a number is missing or b is not positive.
Number quotient(const Number& a, const Number& b);

/// A finished run, with the quantities that the rules evaluate.
struct DiagnosedRun {
  const LoadedScenario& loaded;
  const Result& result;
  const RunObservations& observations;
  const ToolShape* tool;  ///< null if only rules that use metrics are evaluated
  /// K divided by the linear limit, once it was computed: several rules need it, and it costs a few milliseconds.
  mutable std::optional<Number> ratio_to_limit = {};

  const Scenario& scenario() const { return loaded.scenario; }
  template <class... Outcomes>
  bool ended(Outcomes... outcomes) const {
    return ((result.end.outcome == outcomes) || ...);
  }
  /// Returns a metric's value; empty if the run does not have the metric or it has no value.
  Number metric(std::string_view name) const { return number_of(result.metrics, name); }
  bool is_free() const { return position_is_free(scenario().motion); }
  bool has_springs() const { return std::holds_alternative<SpringsEnvironment>(scenario().environment); }
  bool has_hand() const { return !std::holds_alternative<NoHandFields>(scenario().hand); }
  /// Returns the impedance device; null for other devices.
  const ImpedanceDeviceConfig* impedance() const { return std::get_if<ImpedanceDeviceConfig>(&scenario().device); }
  /// Returns a metric divided by the mean force in settled contact. Empty if there was no settled contact, or if
  /// nothing presses the tool: then the mean force is only what friction leaves, and no reference for vibration.
  Number of_mean_force(const char* name) const;
  Number half_width() const { return has_springs() || tool == nullptr ? std::nullopt : Number(tool->half_width()); }
  /// Returns true if the tool vibrates in the last quarter of the run.
  bool vibrates() const;
  /// Returns `number` if it is meaningful for this run, else an empty value. Numbers are not meaningful if the
  /// run diverged, went through the surface or never touched. In a run with springs that come to rest, the mean
  /// force is no reference for force steps.
  Number if_completed(const Number& number) const;
};

/// Returns 1 if the run ended with one of the outcomes and the scene does not expect that outcome, else an empty value:
/// what a scene expects is no problem, and needs no advice.
template <Outcome... outcomes>
Number ended(const DiagnosedRun& run) {
  const bool is_expected = outcome_is_expected(run.scenario().expect, run.result.end.outcome);
  return run.ended(outcomes...) && !is_expected ? Number(1.0) : std::nullopt;
}

/// Thresholds that more than one rule needs.
inline constexpr double kMaxBuzz = 0.1, kMaxLimitRatio = 0.8, kMaxEncoderForce = 0.1, kMaxReduction = 0.1,
                        kMaxChatter = 10.0, kMaxDampingShare = 0.5, kMaxSoftness = 3.0, kMaxCoarseness = 1.15,
                        kMaxSaturation = 0.01;
/// Largest vibration of a tool without settled contact [m/s]. Ten times kMaxVibration, because the landing counts too:
/// a landing at speed v adds v sqrt(2.6 ms / duration).
inline constexpr double kMaxShake = 1e-2;

/// Returns 1 if the run ended because a force law or a module failed, or because a force was not finite; otherwise an
/// empty value.
Number fault(const DiagnosedRun& run);
/// Returns 1 if the run left its bounds although all numbers were finite, and the scene does not expect this; otherwise
/// an empty value.
Number diverged(const DiagnosedRun& run);
/// Returns the mean angle between the rendered force and the force that was measured with the stroke; empty if fewer
/// than 10 steps have both.
Number measured_force_angle(const DiagnosedRun& run);
Number longest_step(const DiagnosedRun& run);
bool step_exceeds_half_width(const DiagnosedRun& run);
Number buzz(const DiagnosedRun& run);
Number pop(const DiagnosedRun& run);
/// Returns the vibration of the tool over all steps [m/s], for a touching run in which buzz() has no meaning.
Number shake(const DiagnosedRun& run);
Number chatter(const DiagnosedRun& run);
/// Returns K divided by the largest stable K of the linear loop in contact, if the run diverged, lost contact or
/// vibrates. Empty without a loop, and if the loop is unstable at any K (unstable_loop()). Rounded to six digits.
Number stability_limit_ratio(const DiagnosedRun& run);
/// Returns 1 if hand and device are unstable without contact by the eigenvalues of their loop, under the conditions of
/// stability_limit_ratio(); otherwise an empty value.
Number unstable_alone(const DiagnosedRun& run);
/// Returns 1 if the linear loop with a contact is unstable even with a stiffness of almost zero, under the conditions
/// of stability_limit_ratio(); otherwise an empty value.
Number unstable_loop(const DiagnosedRun& run);
/// Returns the point spacing divided by the spacing at which four points would be in contact. The number of
/// contacts is proportional to 1 / spacing^2. Empty if the tip moved less than ten spacings in contact.
Number coarseness(const DiagnosedRun& run);
/// Returns the largest damping force that one encoder increment causes, divided by the mean force; empty unless the
/// force vibrates, jumps or reverses.
Number encoder_force(const DiagnosedRun& run);
/// Returns B dt / m along the stiffest contact, divided by the largest value that the integrator can handle. m
/// is the mass of the handle, or of the tool without a device. The limit for a handle is 2.
Number damping_share(const DiagnosedRun& run);
/// Returns the displacement of the tip perpendicular to the force in the last quarter, divided by the tool's
/// half width. Only for a free tool under a constant hand force that stays in contact.
Number drift(const DiagnosedRun& run);
Number depth_in_half_widths(const DiagnosedRun& run);
Number softness(const DiagnosedRun& run);
Number saturation(const DiagnosedRun& run);
/// Returns the number of landings per second that no script causes: without the first landing, and without one landing
/// for each time that the hand's script may have lifted the tool.
Number bounces(const DiagnosedRun& run);

/// Returns the frequency of the vibration as text: half the sign changes of the strongest component of the
/// force above 30 Hz in the last quarter, divided by the duration of this quarter. Empty if there is no
/// vibration.
std::string buzz_frequency(const DiagnosedRun& run);

}  // namespace hapbench
