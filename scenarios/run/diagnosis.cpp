#include "scenarios/run/diagnosis.hpp"

#include <fmt/format.h>

#include <cmath>

#include "algorithms/stages/damping_and_limits.hpp"
#include "device_model/impedance_device.hpp"
#include "scenarios/input/rounding.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/run/vibration_limit.hpp"

namespace hapbench {
namespace {

/// Smallest number of steps in a quarter from which motion and frequency are computed.
constexpr std::uint64_t kMinQuarterSteps = 10;

using Number = std::optional<double>;

/// Returns a / b; empty if a number is missing or b is not positive.
Number quotient(const Number& a, const Number& b) {
  return a && b && *b > 0.0 ? Number(*a / *b) : std::nullopt;
}

Number share(std::uint64_t rows, std::uint64_t of) {
  return quotient(static_cast<double>(rows), static_cast<double>(of));
}

/// A finished run, with the quantities that the rules evaluate.
struct DiagnosedRun {
  const LoadedScenario& loaded;
  const Result& result;
  const RunObservations& observations;
  const ToolShape* tool;  ///< null if only rules that use metrics are evaluated

  const Scenario& scenario() const { return loaded.scenario; }
  template <class... Outcomes>
  bool ended(Outcomes... outcomes) const {
    return ((result.end.outcome == outcomes) || ...);
  }
  /// Returns a metric's value; empty if the run does not have the metric or it has no value.
  Number metric(std::string_view name) const { return number_of(result.metrics, name); }
  /// Returns a metric divided by the mean force in settled contact; empty if there was no settled contact.
  Number of_mean_force(const char* name) const { return quotient(metric(name), metric("force_mean_in_contact_N")); }
  Number half_width() const { return has_springs() ? std::nullopt : Number(tool->half_width()); }
  bool vibrates() const { return metric("vibration_last_quarter_m_per_s").value_or(0.0) > kMaxVibration; }
  bool is_free() const { return position_is_free(scenario().motion); }
  bool has_springs() const { return std::holds_alternative<SpringsEnvironment>(scenario().environment); }
  /// Returns `number` if it is meaningful for this run, else an empty value. Numbers are not meaningful if the
  /// run diverged, went through the surface or never touched. In a run with springs that come to rest, the mean
  /// force is no reference for force steps.
  Number if_completed(const Number& number) const {
    if (has_springs() && !vibrates()) return std::nullopt;
    return ended(Outcome::diverges, Outcome::went_through, Outcome::no_contact) ? std::nullopt : number;
  }
};

// ---- Numbers that the rules compare with their thresholds

template <Outcome... kOutcomes>
Number ended(const DiagnosedRun& run) {
  return run.ended(kOutcomes...) ? Number(1.0) : std::nullopt;
}

Number longest_step(const DiagnosedRun& run) {
  return quotient(run.observations.longest_step, run.half_width());
}

bool step_exceeds_half_width(const DiagnosedRun& run) {
  return longest_step(run).value_or(0.0) > 1.0;
}

Number buzz(const DiagnosedRun& run) {
  return run.if_completed(run.of_mean_force("force_rms_above_30Hz_N"));
}

/// Returns the frequency of the vibration as text: half the sign changes of the strongest component of the
/// force above 30 Hz in the last quarter, divided by the duration of this quarter. Empty if there is no
/// vibration.
std::string buzz_frequency(const DiagnosedRun& run) {
  const RunObservations::Quarter& last = run.observations.last_quarter;
  Eigen::Index axis = 0;
  if (last.rows < kMinQuarterSteps || !(last.high_squares.maxCoeff(&axis) > 0.0)) return "";
  const double turns = static_cast<double>(last.high_sign_changes[static_cast<std::size_t>(axis)]);
  return fmt::format(", at about {:.0f} Hz", 0.5 * turns / (run.scenario().time.step * static_cast<double>(last.rows)));
}

/// Returns K divided by the largest stable K of the linear loop in contact. The loop uses the stiffest contact
/// of the run (largest stiffness ratio lambda). Empty without contact or without a loop. Rounded to six digits,
/// so that the result does not depend on how a build rounds.
Number ratio_to_stability_limit(const DiagnosedRun& run) {
  const Number lambda = run.metric("ratio_max");
  const double K = run.scenario().rendering.stiffness;
  if (!lambda || !(*lambda > 0.0) || !(K > 0.0) || !run.is_free()) return std::nullopt;
  if (contact_step_matrix(run.scenario(), *lambda).size() == 0) return std::nullopt;
  constexpr double kMin = 1e-9, kMax = 2.0;  // search range, in units of K; above it, K is far below the limit
  Scenario at = run.scenario();
  const double limit = first_stability_limit(kMin * K, kMax * K, [&](double stiffness) {
    at.rendering.stiffness = stiffness;
    return contact_step_matrix(at, *lambda);
  });
  if (limit == 0.0) return std::nullopt;  // no K is stable: the rule "servo" names the cause
  return rounded_to_digits(K / limit, 6);
}

/// Returns true if a run vibrates, diverges or loses contact, as it does with an unstable loop.
bool looks_unstable(const DiagnosedRun& run) {
  return run.ended(Outcome::diverges, Outcome::lost_contact) || run.vibrates() || buzz(run).value_or(0.0) > 0.1;
}

/// Returns 1 for a run that looks unstable and whose loop of hand and device is unstable without contact, by its
/// eigenvalues.
Number unstable_alone(const DiagnosedRun& run) {
  if (!run.is_free() || !looks_unstable(run)) return std::nullopt;
  return unstable_without_wall(run.scenario()).empty() ? Number(std::nullopt) : Number(1.0);
}

/// Returns the part that is unstable alone, as text.
std::string unstable_part(const DiagnosedRun& run) {
  return ": " + unstable_without_wall(run.scenario());
}

/// Returns ratio_to_stability_limit() if the run diverged, lost contact or vibrates, else an empty value.
Number stability_limit_ratio(const DiagnosedRun& run) {
  return looks_unstable(run) ? ratio_to_stability_limit(run) : std::nullopt;
}

/// Returns the point spacing divided by the spacing at which four points would be in contact. The number of
/// contacts is proportional to 1 / spacing^2. Empty if the tip moved less than ten spacings in contact.
Number coarseness(const DiagnosedRun& run) {
  constexpr double kSufficientContacts = 4.0,
                   kMinSpacings = 10.0;  // contacts in a step; multiples of the point spacing
  const auto distance = point_distance(run.loaded);
  const Number contacts = quotient(run.metric("colliding_mean"), run.metric("contact_share"));
  if (!distance || !contacts || run.observations.path_in_contact < kMinSpacings * distance->metres) return std::nullopt;
  return run.if_completed(std::sqrt(kSufficientContacts / *contacts));
}

/// Returns the largest damping force that one encoder increment causes, divided by the mean force.
Number encoder_force(const DiagnosedRun& run) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&run.scenario().device);
  if (device == nullptr) return std::nullopt;
  // Steps in which a velocity filter of any order reaches its peak or passes almost nothing.
  constexpr int kSamples = 100;
  VelocityFilter filter(device->velocity_filter, run.scenario().time.step);
  filter.reset(Vec3::Zero());
  double fastest = 0.0;
  for (int i = 0; i < kSamples; ++i) fastest = std::max(fastest, filter.read(Vec3(device->encoder_step, 0.0, 0.0)).x());
  return quotient(normal_damping(run.scenario().rendering) * fastest, run.metric("force_mean_in_contact_N"));
}

/// Returns B dt / m along the stiffest contact, divided by the largest value that the integrator can handle. m
/// is the mass of the handle, or of the tool without a device. The limit for a handle is 2.
Number damping(const DiagnosedRun& run) {
  const Scenario& s = run.scenario();
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&s.device);
  const Number lambda = run.metric("ratio_max");
  if (!lambda || !run.is_free()) return std::nullopt;
  double B = *lambda * normal_damping(s.rendering);
  if (const auto& most = s.rendering.max_damping) B = std::min(B, *most);
  const double mass = device != nullptr ? device->handle_mass : s.rendering.mass;
  return B * s.time.step / mass / (device != nullptr ? 2.0 : s.integrator.type->damper_limit);
}

/// Returns the displacement of the tip perpendicular to the force in the last quarter, divided by the tool's
/// half width. Only for a free tool that stays in contact and that no script moves.
Number drift(const DiagnosedRun& run) {
  const RunObservations& rows = run.observations;
  const RunObservations::Quarter& last = rows.last_quarter;
  if (last.rows < kMinQuarterSteps || !last.always_in_contact || has_scripted_motion(run.scenario()) || !run.is_free())
    return std::nullopt;
  // Remove the component along the force.
  const Vec3 push = rows.last_force.normalized(), motion = rows.tip - last.start;
  return run.if_completed(quotient((motion - motion.dot(push) * push).norm(), run.half_width()));
}

// ---- Sentences that depend on the run

/// Returns the names in `laws` without the run's own law, joined by "or".
std::string other_laws(const DiagnosedRun& run, std::initializer_list<const char*> laws) {
  std::string text;
  for (const char* law : laws)
    if (run.result.algorithm != law) text += (text.empty() ? "" : " or ") + std::string(law);
  return text;
}

constexpr const char* kShorterStep = "a shorter time.step_s: in one step the tool moves by more than its half width";

std::string against_sinking(const DiagnosedRun& run) {
  if (step_exceeds_half_width(run)) return kShorterStep;
  if (!run.is_free()) return "another motion.position, because the script moves the tool there";
  return "a larger K or a smaller hand force; if the rule \"soft\" is listed, another algorithm";
}

std::string against_loss(const DiagnosedRun& run) {
  if (step_exceeds_half_width(run)) return kShorterStep;
  if (run.ended(Outcome::no_contact))
    return "check environment.scale, initial.position_m and the hand's direction (\"hapbench validate\" prints sizes "
           "and distances); if the tool came nearer until the end of the run, more time.steps";
  return "a smaller K if the rule \"edge\" is listed, or a hand whose path ends on the surface";
}

std::string laws_that_never_soften(const DiagnosedRun& run) {
  return "an algorithm whose stiffness does not fall with the number of contacts, such as " +
         other_laws(run, {"shaped_stiffness", "exact_shaping", "proxy"});
}

std::string laws_that_never_add_up(const DiagnosedRun& run) {
  return "K divided by this number, or an algorithm whose contacts do not add up, such as " +
         other_laws(run, {"shaped_stiffness", "mean"});
}

std::string point_spacing(const DiagnosedRun& run) {
  return fmt::format(", {}", length_text(point_distance(run.loaded)->metres));
}

// ---- Rules

/// A sentence that is either constant or computed from the run.
struct Sentence {
  constexpr Sentence(const char* sentence) : constant(sentence) {}  // NOLINT: for the table below
  constexpr Sentence(std::string (*function)(const DiagnosedRun& run)) : of_run(function) {}  // NOLINT
  std::string text(const DiagnosedRun& run) const { return of_run != nullptr ? of_run(run) : constant; }

  const char* constant = "";
  std::string (*of_run)(const DiagnosedRun& run) = nullptr;
};

/// A rule of the diagnosis. Its advice never names the run's own law, and never names a cause that was not
/// measured.
struct Rule {
  const char *name, *number, *unit;  ///< name of the rule; description of its number; unit of the number
  double threshold;                  ///< the rule reports a problem if the number is larger
  const char* says;                  ///< the problem; {} stands for the number
  Number (*value)(const DiagnosedRun& run);
  Sentence attempt;
  Sentence more = "";          ///< further facts, appended to the problem
  bool low_vibration = false;  ///< included in diagnosis_rules(true)
  bool warns = false;          ///< reported as a warning for runs without a diagnosis; such a rule uses metrics only
};

constexpr Rule kRules[] = {
    {"diverged", "1 if the run diverged (left its bounds)", "1", 0.5, "the run diverged", ended<Outcome::diverges>,
     "a shorter time.step_s or a smaller K; \"hapbench tune\" finds K and zeta"},
    {"sank", "1 if the tool passed through the surface", "1", 0.5, "the tool passed through the surface",
     ended<Outcome::went_through>, against_sinking},
    {"lost", "1 if the tool never touched the environment, or lost contact before the end", "1", 0.5,
     "the tool never touched the surface, or lost contact before the end",
     ended<Outcome::no_contact, Outcome::lost_contact>, against_loss},
    {"stuck", "1 if the hand's target moved on and the tool did not", "1", 0.5, "the tool is stuck",
     ended<Outcome::stuck, Outcome::not_dragged>,
     "a stiffer hand, or less friction if the scene has friction; \"hapbench compare --algorithms all\" shows with "
     "which algorithms the tool moves on"},
    {"step", "largest displacement of the tip in one time step near the surface, divided by the tool's half width", "1",
     1.0, "near the surface the tool moves by up to {} of its half widths in one time step", longest_step,
     "a shorter time.step_s or a slower hand"},
    {"servo", "1 if hand and device are unstable without contact, by the eigenvalues of their loop", "1", 0.5,
     "the loop is unstable without contact", unstable_alone,
     "a shorter delay, a softer servo (device.servo.stiffness_N_per_m) or a hand with more damping; no K helps",
     unstable_part},
    {"edge",
     "K divided by the linear limit of the loop of device, tool and stiffest contact (without dry friction), in a run "
     "that vibrates, diverges or loses contact",
     "1", 0.8, "K is {} times the linear stability limit", stability_limit_ratio,
     "a smaller K, a shorter time.step_s, or a shorter delay or filter if the device has one; \"hapbench tune\" finds "
     "a stable setting"},
    {"buzz", "rms of the force above 30 Hz, divided by the mean force in settled contact", "1", 0.1,
     "the force vibrates: its rms above 30 Hz is {} of the mean force", buzz,
     "a smaller K; if the rule \"encoder\" is also listed, a velocity filter or a smaller zeta; \"hapbench tune "
     "--bound force_rms_above_30Hz_N=0.05\"",
     buzz_frequency, true},
    {"pop", "largest force step in settled contact, divided by the mean force", "1", 0.5,
     "the force jumps: in settled contact one force step is {} of the mean force",
     [](const DiagnosedRun& r) { return r.if_completed(r.of_mean_force("settled_force_step_max_N")); },
     "if the rule \"reduction\" is also listed, rendering.reduction null; \"hapbench compare --algorithms all\" shows "
     "which algorithm has the smallest force steps",
     "", true},
    {"reduction",
     "largest force step at a change of the contacts kept by rendering.reduction, divided by the mean force in "
     "settled contact",
     "1", 0.1, "the force jumps by {} of its mean when the set of contacts kept by rendering.reduction changes",
     [](const DiagnosedRun& r) { return r.of_mean_force("reduction_force_step_max_N"); }, "rendering.reduction null",
     "", false, true},
    {"facets",
     "spacing of the surface's points, divided by the spacing at which four points are in contact, for a tool that "
     "moves along the surface",
     "1", 1.15,
     "the surface is sampled coarsely: the spacing of its points is {} times the spacing that keeps four points in "
     "contact",
     coarseness,
     "half of environment.spacing_m or grid_m; \"hapbench compare --errors\" shows which metrics depend on it",
     point_spacing},
    {"deep", "median depth of the tool below the surface in settled contact, divided by its half width", "1", 0.75,
     "the tool sinks into the surface by {} of its half width",
     [](const DiagnosedRun& r) { return r.if_completed(quotient(r.metric("inside_settled_m"), r.half_width())); },
     "a larger K; \"hapbench tune --bound inside_max_m=3e-4\" finds whether a stable K keeps this depth"},
    {"soft", "K divided by the combined stiffness along the softest contact (1 / ratio_min)", "1", 3.0,
     "along some contact the rendered stiffness is {} times smaller than K",
     [](const DiagnosedRun& r) { return quotient(1.0, r.metric("ratio_min")); }, laws_that_never_soften},
    {"hard", "combined stiffness along the stiffest contact, divided by K (ratio_max)", "1", 3.0,
     "the stiffnesses of the contacts add up to {} K", [](const DiagnosedRun& r) { return r.metric("ratio_max"); },
     laws_that_never_add_up},
    {"damping",
     "B dt / m of the moving mass along the stiffest contact, divided by the stability limit of one integration step",
     "1", 0.5, "the damping is {} of the largest damping at which one time step is stable", damping,
     "a smaller zeta, a shorter time.step_s, or a smaller rendering.limits.max_damping_N_s_per_m"},
    {"friction",
     "number of steps with a force above explicit_friction_limit_N, beyond which explicit integration of friction is "
     "unstable",
     "1", 0.0,
     "explicit integration of friction is unstable in {} steps: the motion after them is a numerical artefact",
     [](const DiagnosedRun& r) { return r.metric("explicit_friction_rows_beyond"); },
     R"(smaller rendering.friction.mu_f_s_per_m, {"type": "dry"}, or a shorter step)", "", false, true},
    {"encoder", "force that one encoder step causes through the damping B, divided by the mean force", "1", 0.1,
     "each encoder step causes a force of {} of the mean force, through the damping", encoder_force,
     "a smaller zeta, a finer encoder, or a low-pass device.velocity_filter (with a lower cutoff_Hz if the device has "
     "one)"},
    {"saturated", "fraction of the steps in contact in which the force is at its upper limit", "1", 0.01,
     "the force is saturated during {} of the contact time",
     [](const DiagnosedRun& r) { return share(r.observations.at_force_limit, r.observations.in_contact); },
     "a smaller K or a smaller hand force; a stronger device, or a larger rendering.limits.max_force_N if the "
     "scenario sets it"},
    {"limiter", "fraction of the steps in contact in which the input-force limiter of the device cuts the hand's force",
     "1", 0.2, "the device's limiter cuts the hand's force during {} of the contact time",
     [](const DiagnosedRun& r) { return share(r.observations.at_input_limit, r.observations.in_contact); },
     "a smaller hand force, or a larger device.force_limit_N (f_th in section 2.7 of the thesis)"},
    {"bounces", "number of landings per second of a tool that no script moves", "1/s", 8.0,
     "the tool bounces: {} landings per second",
     [](const DiagnosedRun& r) {
       return r.is_free() ? quotient(r.metric("landings"), r.result.duration) : std::nullopt;
     },
     "a larger zeta or a smaller K"},
    {"chatter",
     "number of force reversals (by more than 90 degrees from one step to the next) per second in settled contact",
     "1/s", 10.0, "the force chatters: it reverses {} times per second",
     [](const DiagnosedRun& r) { return r.if_completed(r.metric("force_reversals_per_s")); },
     "a smaller K; \"hapbench compare --algorithms all\" shows which algorithm has the fewest reversals in this scene",
     "", true},
    {"energy", "net energy created by the rendering", "J", 1e-3, "the rendering created {} J of net energy",
     [](const DiagnosedRun& r) { return r.if_completed(r.metric("passivity.net_created_J")); },
     "a smaller K, or rendering.passivity_controller if it is off", "", true},
    {"drift",
     "displacement across the force in the last quarter of the run, of a tool under a constant hand force, divided by "
     "the tool's half width",
     "1", 0.05, "the tool drifts by {} of its half width in the last quarter of the run, under a constant hand force",
     drift, "rendering.friction {\"type\": \"dry\"} with a sufficient mu; viscous friction cannot hold a tool"},
};

/// Evaluates the rules for which the member `mark` is true, or all rules if `mark` is null. With
/// `beyond_threshold`, returns only the rules whose threshold is exceeded.
std::vector<Diagnosed> diagnosed(const DiagnosedRun& run, bool Rule::*mark, bool beyond_threshold) {
  std::vector<Diagnosed> found;
  for (const Rule& rule : kRules) {
    if (mark != nullptr && !(rule.*mark)) continue;
    const Number value = rule.value(run);
    if (!value || (beyond_threshold && !(*value > rule.threshold))) continue;
    const std::string says = fmt::format(fmt::runtime(rule.says), fmt::format("{:.3g}", *value));
    found.push_back({rule.name, rule.number, rule.unit, *value, rule.threshold, says + rule.more.text(run),
                     rule.attempt.text(run)});
  }
  return found;
}

}  // namespace

std::vector<Diagnosed> diagnosis_rules(bool low_vibration) {
  std::vector<Diagnosed> rules;
  for (const Rule& rule : kRules)
    if (rule.low_vibration || !low_vibration)
      rules.push_back({rule.name, rule.number, rule.unit, 0.0, rule.threshold, "", ""});
  return rules;
}

std::vector<Diagnosed> diagnosis_findings(const LoadedScenario& loaded, const Result& result,
                                          const RunObservations& observations, const ToolShape& tool) {
  return diagnosed({loaded, result, observations, &tool}, nullptr, /*beyond_threshold=*/true);
}

std::vector<Diagnosed> low_vibration_numbers(const LoadedScenario& loaded, const Result& result) {
  return diagnosed({loaded, result, {}, nullptr}, &Rule::low_vibration, /*beyond_threshold=*/false);
}

std::vector<Warning> rule_warnings(const LoadedScenario& loaded, const Result& result) {
  std::vector<Warning> warnings;
  for (Diagnosed& found : diagnosed({loaded, result, {}, nullptr}, &Rule::warns, /*beyond_threshold=*/true))
    warnings.push_back({found.rule, "", fmt::format("{}; try: {}", found.says, found.attempt)});
  return warnings;
}

}  // namespace hapbench
