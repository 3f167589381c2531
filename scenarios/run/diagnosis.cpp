#include "scenarios/run/diagnosis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/diagnosed_run.hpp"
#include "scenarios/run/diagnosis_advice.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_loop.hpp"

namespace hapbench {
namespace {

std::string point_spacing(const DiagnosedRun& run) {
  return fmt::format(", {}", length_text(point_distance(run.loaded)->metres));
}

Number share(std::uint64_t rows, std::uint64_t of) {
  return quotient(static_cast<double>(rows), static_cast<double>(of));
}

/// Rule::more of rules that append nothing to their text.
std::string no_more(const DiagnosedRun&) {
  return "";
}

/// Marks of rules.
enum Mark : unsigned {
  kFailure = 1,       ///< the rule has RuleKind::failure
  kLowVibration = 2,  ///< the rule has RuleKind::low_vibration
  kWarns = 4,         ///< reported as a warning for runs without a diagnosis; such a rule uses metrics only
  kByLaw = 8          ///< a law that pulls the tool into the surface can cause the problem
};

/// A rule of the diagnosis.
struct Rule {
  const char *name, *number, *unit;  ///< name of the rule; description of its number; unit of the number
  double threshold;                  ///< the rule reports a problem if the number is larger
  const char* says;                  ///< the problem; {} stands for the number
  Number (*value)(const DiagnosedRun& run);
  std::string (*attempt)(const DiagnosedRun& run);         ///< what to change (diagnosis_advice.hpp)
  std::string (*more)(const DiagnosedRun& run) = no_more;  ///< further facts, appended to the problem
  unsigned marks = 0;                                      ///< marks of the rule (Mark)
};

constexpr Rule kRules[] = {
    {"fault", "1 if the law or a module failed, or gave a number that is not finite", "1", 0.5,
     "a fault of the force law or of a module ended the run", fault, against_fault,
     [](const DiagnosedRun& r) { return ": " + divergence_text(r.result); }, kFailure},
    {"diverged", "1 if the run diverged (left its bounds)", "1", 0.5, "the run diverged", diverged, against_divergence,
     no_more, kFailure | kByLaw},
    {"inward",
     "fraction of the steps in contact in which the spring force of a law in a module or in Python points deeper into "
     "the surface at every contact",
     "1", kMaxInward, "the law pulls the tool into the surface during {} of the contact time", inward_share,
     against_inward_force},
    {"sank", "1 if the tool passed through the surface", "1", 0.5, "the tool passed through the surface",
     ended<Outcome::went_through>, against_sinking, no_more, kFailure},
    {"lost", "1 if the tool never touched the environment, or lost contact before the end", "1", 0.5,
     "the tool never touched the surface, or lost contact before the end",
     ended<Outcome::no_contact, Outcome::lost_contact>, against_loss, no_more, kFailure | kByLaw},
    {"stuck", "1 if the hand's target moved on and the tool did not", "1", 0.5, "the tool is stuck",
     ended<Outcome::stuck, Outcome::not_dragged>, against_standstill, no_more, kFailure},
    {"step", "largest displacement of the tip in one time step near the surface, divided by the tool's half width", "1",
     1.0, "near the surface the tool moves by up to {} times its half width in one time step", longest_step,
     against_long_steps},
    {"servo", "1 if hand and device are unstable without contact, by the eigenvalues of their loop", "1", 0.5,
     "the loop is unstable without contact", unstable_alone, against_unstable_servo,
     [](const DiagnosedRun& r) { return ": " + unstable_without_wall(r.scenario()); }, kFailure},
    {"edge",
     "K divided by the linear limit of the loop of device, hand, tool and contact (without dry friction and without a "
     "slow drift along the surface), in a run that vibrates, diverges or loses contact",
     "1", kMaxLimitRatio, "K is {} times the linear stability limit", stability_limit_ratio, against_unstable_stiffness,
     no_more, kLowVibration | kByLaw},
    {"loop",
     "1 if the loop of device, hand, tool and contact is unstable even at K / 10000, in a run that vibrates, diverges "
     "or loses contact",
     "1", 0.5, "the loop is unstable even at K / 10000: K is not the cause", unstable_loop, against_unstable_loop,
     no_more, kFailure | kByLaw},
    {"buzz", "rms of the force above 30 Hz, divided by the mean force in settled contact of a pressed tool", "1",
     kMaxBuzz, "the force vibrates: its part above 30 Hz has an rms of {} times the mean force", buzz, against_buzz,
     buzz_frequency, kLowVibration | kByLaw},
    {"pop", "largest force step in settled contact, divided by the mean force of a pressed tool", "1", 0.5,
     "the force jumps: the largest force step in settled contact is {} times the mean force", pop, against_pops,
     no_more, kLowVibration | kByLaw},
    {"shake",
     "rms of the tool's velocity above 30 Hz over the run, if the rule buzz has no number: without settled contact, or "
     "for a tool that nothing presses",
     "m/s", kMaxShake, "the tool vibrates: the rms of its velocity above 30 Hz is {} m/s", shake, against_shaking,
     no_more, kLowVibration | kByLaw},
    {"reduction",
     "largest force step at a change of the contacts kept by rendering.reduction, divided by the mean force in "
     "settled contact",
     "1", kMaxReduction,
     "the force jumps by {} times its mean when the set of contacts kept by rendering.reduction changes",
     [](const DiagnosedRun& r) { return r.of_mean_force("reduction_force_step_max_N"); }, against_reduction, no_more,
     kWarns},
    {"facets",
     "spacing of the surface's points, divided by the spacing at which four points are in contact, for a tool that "
     "moves along the surface",
     "1", kMaxCoarseness,
     "the surface is sampled coarsely: the spacing of its points is {} times the spacing that keeps four points in "
     "contact",
     coarseness, against_coarseness, point_spacing},
    {"deep", "median depth of the tool below the surface in settled contact, divided by its half width", "1", 0.75,
     "the tool sinks into the surface by {} times its half width", depth_in_half_widths, against_depth, no_more,
     kByLaw},
    {"soft", "K divided by the combined stiffness along the softest contact (1 / ratio_min)", "1", kMaxSoftness,
     "along some contact the rendered stiffness is {} times smaller than K", softness, against_softness, no_more,
     kByLaw},
    {"hard", "combined stiffness along the stiffest contact, divided by K (ratio_max)", "1", 3.0,
     "the stiffnesses of the contacts add up to {} K", [](const DiagnosedRun& r) { return r.metric("ratio_max"); },
     against_sums, no_more, kByLaw},
    {"damping",
     "B dt / m of the moving mass along the stiffest contact, divided by the stability limit of one integration step",
     "1", kMaxDampingShare,
     "the damping is {} times the largest damping for which the integrator is stable with this time step",
     damping_share, against_damping},
    {"friction",
     "number of steps with a force above explicit_friction_limit_N, beyond which explicit integration of friction is "
     "unstable",
     "1", 0.0,
     "explicit integration of friction is unstable (number of unstable steps: {}): the motion after these steps is a "
     "numerical artefact",
     [](const DiagnosedRun& r) { return r.metric("explicit_friction_rows_beyond"); }, against_friction, no_more,
     kWarns},
    {"encoder",
     "force that one encoder step causes through the damping B, divided by the mean force, if the force vibrates, "
     "jumps "
     "or reverses",
     "1", kMaxEncoderForce, "each encoder step causes a force of {} times the mean force, through the damping",
     encoder_force, against_encoder},
    {"saturated", "fraction of the steps in contact in which the force is at its upper limit", "1", kMaxSaturation,
     "the force is at its upper limit during {} of the contact time", saturation, against_saturation, no_more, kByLaw},
    {"limiter", "fraction of the steps in contact in which the input-force limiter of the device cuts the hand's force",
     "1", 0.2, "the device's limiter cuts the hand's force during {} of the contact time",
     [](const DiagnosedRun& r) { return share(r.observations.at_input_limit, r.observations.in_contact); },
     against_input_limit},
    {"bounces",
     "number of landings per second; not counted are the first landing, one landing for each period or waypoint of the "
     "hand's script, and two for each of a script of the orientation",
     "1/s", 8.0, "the tool bounces: {} landings per second", bounces, against_bounces, no_more, kLowVibration | kByLaw},
    {"chatter",
     "number of force reversals (by more than 90 degrees from one step to the next) per second in settled contact of a "
     "pressed tool",
     "1/s", kMaxChatter, "the force chatters: it reverses {} times per second", chatter, against_chatter, no_more,
     kLowVibration | kByLaw},
    {"energy", "net energy created by the rendering; on an impedance device, by the force of the motors at the handle",
     "J", kMaxCreatedEnergy, "net energy of {} J was created", created_energy, against_energy, created_by,
     kLowVibration | kByLaw},
    {"force_sign", "mean angle between the rendered force and the force measured with the stroke", "rad", 2.6,
     "the measured force is opposite to the rendered force (mean angle {} rad), like a force of the tool on the "
     "surface",
     measured_force_angle, against_reversed_force, no_more, kWarns},
    {"drift",
     "displacement across the force in the last quarter of the run, of a tool under a constant hand force, divided by "
     "the tool's half width",
     "1", 0.05,
     "the tool drifts by {} times its half width in the last quarter of the run, under a constant hand force", drift,
     against_drift},
};

RuleKind kind_of(const Rule& rule) {
  if ((rule.marks & kFailure) != 0) return RuleKind::failure;
  return (rule.marks & kLowVibration) != 0 ? RuleKind::low_vibration : RuleKind::hint;
}

/// Returns the advice of a rule. If the law pulls a free tool into the surface, this law can be the cause: the advice
/// is then to correct the law, unless it is meant to attract.
std::string advice(const Rule& rule, const DiagnosedRun& run) {
  std::string own = rule.attempt(run);
  if ((rule.marks & kByLaw) == 0 || !run.is_free() || !pulls_inwards(run)) return own;
  return fmt::format("{}, or, if the law is meant to attract: {}", correct_pulling_law(), own);
}

/// Evaluates the rules with a mark, or all rules if `mark` is 0. If `beyond_threshold` is true, returns only the rules
/// whose threshold is exceeded, with advice. Otherwise returns all evaluated rules that have a number, without advice.
std::vector<Diagnosed> diagnosed(const DiagnosedRun& run, unsigned mark, bool beyond_threshold) {
  std::vector<Diagnosed> found;
  for (const Rule& rule : kRules) {
    if (mark != 0 && (rule.marks & mark) == 0) continue;
    // If the run ended by a fault of a law or a module, report only the fault. The other rules would name causes that
    // did not end the run.
    if (beyond_threshold && rule.value != fault && fault(run)) continue;
    const Number value = rule.value(run);
    if (!value || (beyond_threshold && !(*value > rule.threshold))) continue;
    std::string says = fmt::format(fmt::runtime(rule.says), fmt::format("{:.3g}", *value));
    if (*value > rule.threshold) says += rule.more(run);
    found.push_back({rule.name, rule.number, rule.unit, *value, rule.threshold, std::move(says),
                     beyond_threshold ? advice(rule, run) : ""});
  }
  return found;
}

}  // namespace

const char* rule_kind_name(RuleKind kind) noexcept {
  if (kind == RuleKind::failure) return "failure";
  return kind == RuleKind::low_vibration ? "vibration" : "hint";
}

std::vector<Diagnosed> diagnosis_rules(std::optional<RuleKind> kind) {
  std::vector<Diagnosed> rules;
  for (const Rule& rule : kRules)
    if (!kind || kind_of(rule) == *kind)
      rules.push_back({rule.name, rule.number, rule.unit, 0.0, rule.threshold, rule.says, ""});
  return rules;
}

std::string rule_names(RuleKind kind) {
  return fmt::format("{}", fmt::join(names_of(diagnosis_rules(kind), &Diagnosed::rule), ", "));
}

RuleKind rule_kind(std::string_view rule) {
  return kind_of(*std::ranges::find(kRules, rule, &Rule::name));
}

std::vector<Diagnosed> diagnosis_findings(const LoadedScenario& loaded, const Result& result,
                                          const RunObservations& observations, const ToolShape& tool,
                                          std::shared_ptr<const PointShell> shell) {
  return diagnosed({loaded, result, observations, &tool, std::move(shell)}, 0, /*beyond_threshold=*/true);
}

std::vector<Diagnosed> low_vibration_numbers(const LoadedScenario& loaded, const Result& result,
                                             const RunObservations& observations, const ToolShape& tool,
                                             std::shared_ptr<const PointShell> shell) {
  return diagnosed({loaded, result, observations, &tool, std::move(shell)}, kLowVibration,
                   /*beyond_threshold=*/false);
}

std::vector<Warning> rule_warnings(const LoadedScenario& loaded, const Result& result) {
  std::vector<Warning> warnings;
  for (Diagnosed& found : diagnosed({loaded, result, {}, nullptr}, kWarns, /*beyond_threshold=*/true))
    warnings.push_back({found.rule, "", fmt::format("{}; try: {}", found.says, found.attempt)});
  return warnings;
}

}  // namespace hapbench
