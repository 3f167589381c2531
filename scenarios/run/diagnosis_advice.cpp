#include "scenarios/run/diagnosis_advice.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_loop.hpp"

namespace hapbench {
namespace {

constexpr const char* kShorterStep = "a shorter time.step_s: in one step the tool moves by more than its half width";

/// Joins alternatives: "a, b, or c".
std::string either(const std::vector<std::string>& options) {
  if (options.size() < 2) return fmt::format("{}", fmt::join(options, ""));
  const std::vector<std::string> first(options.begin(), options.end() - 1);
  return fmt::format("{}{} or {}", fmt::join(first, ", "), options.size() > 2 ? "," : "", options.back());
}

/// Returns the names in `laws` without the law of the run, joined by "or". If the contacts come from springs, a
/// recording or a module, also leaves out the laws that find contacts themselves.
std::string other_laws(const DiagnosedRun& run, std::initializer_list<const char*> laws) {
  std::vector<std::string> names;
  for (const char* law : laws) {
    const bool finds_contacts = !find_algorithm(law)->reported_depth_model.empty();
    if (finds_contacts && (run.has_springs() || has_external_contacts(run.scenario()))) continue;
    if (run.result.algorithm != law) names.emplace_back(law);
  }
  return fmt::format("{}", fmt::join(names, " or "));
}

std::string laws_that_never_soften(const DiagnosedRun& run) {
  return "an algorithm whose stiffness does not fall with the number of contacts, such as " +
         other_laws(run, {"shaped_stiffness", "exact_shaping", "proxy"});
}

/// Returns the field that sets the damping of the contacts.
std::string damping_field(const RenderingConfig& rendering) {
  if (rendering.hunt_crossley) return parameter::kChi.field;
  return rendering.damping ? parameter::kDamping.field : damping_ratio_field();
}

/// A change of a scenario, and its words in an advice. A change that has a size multiplies or divides by `factor`.
struct LoopChange {
  std::string remedy;
  std::function<void(Scenario&, double factor)> change;
};

bool has_damping(const RenderingConfig& rendering) {
  return normal_damping(rendering) > 0.0 || rendering.hunt_crossley;
}

/// Multiplies the damping of the contacts. `if_zero`: damping ratio that replaces a damping of zero.
void scale_damping(RenderingConfig& rendering, double factor, double if_zero) {
  if (rendering.hunt_crossley) *rendering.hunt_crossley *= factor;
  if (rendering.damping) *rendering.damping *= factor;
  rendering.damping_ratio *= factor;
  if (has_damping(rendering)) return;
  rendering.damping.reset();
  rendering.damping_ratio = if_zero;
}

/// Divides the time step. A delay in seconds stays the same; a delay in samples becomes shorter.
void shorten_step(Scenario& scenario, double factor) {
  scenario.time.step /= factor;
  auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  if (device != nullptr && device->delay) device->delay_samples = *device->delay / scenario.time.step;
}

void remove_filters(Scenario& scenario, double) {
  auto& device = std::get<ImpedanceDeviceConfig>(scenario.device);
  device.velocity_filter = DifferenceFilter{};
  device.position_filter.reset();
}

/// Returns the changes of time step and device that can make a loop stable.
std::vector<LoopChange> device_changes(const Scenario& scenario) {
  std::vector<LoopChange> changes = {{"a shorter time.step_s", shorten_step}};
  if (!device_acts_on_tool(scenario)) return changes;
  if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device)) {
    const auto no_delay = [](Scenario& s, double) { std::get<ImpedanceDeviceConfig>(s.device).delay_samples = 0.0; };
    if (device->position_filter || !std::holds_alternative<DifferenceFilter>(device->velocity_filter))
      changes.push_back({"a filter with a higher cutoff", remove_filters});
    if (device->delay_samples > 0.0) changes.push_back({"a shorter delay of the device", no_delay});
  }
  if (const auto* device = std::get_if<AdmittanceDeviceConfig>(&scenario.device)) {
    changes.push_back({"a softer servo (device.servo.stiffness_N_per_m)", [](Scenario& s, double factor) {
                         std::get<AdmittanceDeviceConfig>(s.device).servo.stiffness /= factor;
                       }});
    if (device->servo.delay > 0)
      changes.push_back({"a shorter delay of device.servo",
                         [](Scenario& s, double) { std::get<AdmittanceDeviceConfig>(s.device).servo.delay = 0; }});
  }
  return changes;
}

/// Returns the changes of the damping of the contacts that can make a loop stable.
std::vector<LoopChange> damping_changes(const Scenario& scenario) {
  const std::string damping = damping_field(scenario.rendering);
  std::vector<LoopChange> changes;
  if (has_damping(scenario.rendering))
    changes.push_back(
        {"a smaller " + damping, [](Scenario& s, double factor) { scale_damping(s.rendering, 1.0 / factor, 0.0); }});
  changes.push_back(
      {"a larger " + damping, [](Scenario& s, double factor) { scale_damping(s.rendering, factor, 0.7); }});
  return changes;
}

/// Multiplies stiffness and damping of the hand.
void scale_hand(HandFields& hand, double stiffness, double damping) {
  const auto scale_spring = [=](ImpedanceHandFields& spring) {
    spring.stiffness *= stiffness;
    spring.damping *= damping;
  };
  if (auto* spring = std::get_if<ImpedanceHandFields>(&hand)) scale_spring(*spring);
  if (auto* passive = std::get_if<MassSpringDamperHandFields>(&hand)) scale_spring(passive->spring);
  if (auto* drag = std::get_if<DragHandFields>(&hand)) drag->drag.normal_damping *= damping;
  if (auto* tracking = std::get_if<TrackingHandFields>(&hand)) {
    for (Subject& subject : tracking->subjects) {
      subject.stiffness *= stiffness;
      subject.damping *= damping;
    }
  }
}

/// Returns the changes of the hand that can make a loop stable.
std::vector<LoopChange> hand_changes() {
  return {{"a hand with more damping", [](Scenario& s, double factor) { scale_hand(s.hand, 1.0, factor); }},
          {"a hand with less damping", [](Scenario& s, double factor) { scale_hand(s.hand, 1.0, 1.0 / factor); }},
          {"a softer hand", [](Scenario& s, double factor) { scale_hand(s.hand, 1.0 / factor, 1.0); }}};
}

/// Returns the changes of both lists.
std::vector<LoopChange> both(std::vector<LoopChange> changes, const std::vector<LoopChange>& further) {
  changes.insert(changes.end(), further.begin(), further.end());
  return changes;
}

/// Returns the remedies of those changes after which the loop is stable, with at least one of several factors.
/// `is_stable`: returns true if the loop is stable after a change of the scenario.
std::vector<std::string> effective(const std::vector<LoopChange>& changes,
                                   const std::function<bool(const std::function<void(Scenario&)>&)>& is_stable) {
  std::vector<std::string> remedies;
  for (const auto& [remedy, change] : changes)
    for (const double factor : {10.0, 3.0}) {
      if (!is_stable([&change = change, factor](Scenario& s) { change(s, factor); })) continue;
      remedies.push_back(remedy);
      break;
    }
  return remedies;
}

bool is_beyond(const Number& number, double threshold) {
  return number.value_or(0.0) > threshold;
}

/// Returns true if K is near or beyond the stability limit of the linear loop.
bool is_too_stiff(const DiagnosedRun& run) {
  return is_beyond(stability_limit_ratio(run), kMaxLimitRatio);
}

/// Returns the changes of device and damping with which the loop is stable at this K.
std::vector<std::string> remedies_at_this_stiffness(const DiagnosedRun& run) {
  return effective(both(device_changes(run.scenario()), damping_changes(run.scenario())),
                   [&](const auto& change) { return is_below_limit(run, change); });
}

/// Returns the advice if the loop is unstable without contact or at any K, so that K is not the cause. Otherwise empty.
std::optional<std::string> against_instability_at_any_stiffness(const DiagnosedRun& run) {
  if (is_beyond(unstable_alone(run), 0.5)) return against_unstable_servo(run);
  if (is_beyond(unstable_loop(run), 0.5)) return against_unstable_loop(run);
  return std::nullopt;
}

/// Returns the advice if the linear loop is unstable: without contact, because of K, or at any K. Empty if it is
/// stable.
std::optional<std::string> against_instability(const DiagnosedRun& run) {
  if (is_too_stiff(run)) return "a smaller K: the rule \"edge\" names the stability limit";
  return against_instability_at_any_stiffness(run);
}

/// Returns the remedies for measured causes of a rough force.
std::vector<std::string> against_measured_causes(const DiagnosedRun& run) {
  std::vector<std::string> remedies;
  if (const auto frequency = scripted_vibration(run))
    remedies.push_back(
        fmt::format("a slower script: hand or tool move by a script of {:.3g} Hz, and so does the force", *frequency));
  if (is_too_stiff(run)) remedies.emplace_back("a smaller K");
  if (is_beyond(unstable_loop(run), 0.5)) remedies.push_back(against_unstable_loop(run));
  if (is_beyond(encoder_force(run), kMaxEncoderForce)) remedies.push_back(against_encoder(run));
  if (is_beyond(run.of_mean_force("reduction_force_step_max_N"), kMaxReduction))
    remedies.push_back(against_reduction(run));
  if (run.tool != nullptr && is_beyond(coarseness(run), kMaxCoarseness)) remedies.push_back(against_coarseness(run));
  if (noise_explains_vibration(run, position_noise_force(run)))
    remedies.emplace_back("a velocity filter against device.position_noise_m");
  if (noise_explains_vibration(run, sensor_noise_force(run))) remedies.emplace_back("a smaller device.sensor.noise_N");
  return remedies;
}

/// Returns true if the damping of the contacts is less than a twentieth of the critical damping.
bool is_nearly_undamped(const DiagnosedRun& run) {
  const RenderingConfig& r = run.scenario().rendering;
  constexpr double kNearlyUndamped = 0.05;
  return !r.hunt_crossley && normal_damping(r) < kNearlyUndamped * 2.0 * std::sqrt(r.stiffness * r.mass);
}

/// Returns the advice against a rough force: remedies for the measured causes or, if no cause was measured, a smaller K
/// for a tool that is free to move. `laws`: the words after "… shows which algorithm has" in the last sentence.
/// `metric`: metric by which the algorithms are compared.
std::string against_roughness(const DiagnosedRun& run, const char* laws, const char* metric) {
  // No algorithm and no K help a loop that is unstable without contact.
  if (is_beyond(unstable_alone(run), 0.5)) return against_unstable_servo(run);
  std::vector<std::string> remedies = against_measured_causes(run);
  const std::string comparison =
      fmt::format("\"hapbench compare SCENARIO --algorithms all --by {}\" shows which algorithm has {}", metric, laws);
  if (!remedies.empty()) return either(remedies) + "; " + comparison;
  // If a script moves the tool, the contacts do not depend on K, and a smaller K scales all forces by the same factor.
  if (!run.is_free()) return "another algorithm or a smoother motion; " + comparison;
  if (is_nearly_undamped(run))
    return fmt::format("a larger {} (the contact is nearly undamped), or another algorithm; {}",
                       damping_field(run.scenario().rendering), comparison);
  return "a smaller K or another algorithm; " + comparison;
}

}  // namespace

std::string damping_ratio_field() {
  return std::string(parameter::kDampingRatio.field) + " (zeta)";
}

bool pulls_inwards(const DiagnosedRun& run) {
  return is_beyond(inward_share(run), kMaxInward);
}

std::string correct_pulling_law() {
  return "a law that pushes the tool out: see the rule \"inward\"";
}

std::string against_fault(const DiagnosedRun& run) {
  const Divergence& divergence = run.result.end.divergence;
  const char* what = std::string_view(divergence.quantity) == "contacts" ? "contact module" : "law or module";
  if (!divergence.fault.empty())
    return fmt::format("correct the {} that reports: {}; neither the time step nor K is the cause", what,
                       divergence.fault);
  return fmt::format(
      "correct the code of this {}, for example by a test for a division by 0; neither the time step nor K is the "
      "cause",
      what);
}

std::string against_divergence(const DiagnosedRun& run) {
  if (run.observations.in_contact == 0)
    return "check the hand, the device (servo gains, delay) and time.step_s: the run diverged without contact, so K "
           "has no effect";
  if (is_beyond(unstable_alone(run), 0.5)) return against_unstable_servo(run);
  std::vector<std::string> remedies;
  if (is_beyond(unstable_loop(run), 0.5)) remedies.push_back(against_unstable_loop(run));
  if (is_beyond(damping_share(run), 1.0)) remedies.push_back("a smaller " + damping_field(run.scenario().rendering));
  if (has_multi_rate_contacts(run.scenario()))
    remedies.emplace_back("a smaller rendering.contacts.every or a smaller K");
  if (is_beyond(run.metric("explicit_friction_rows_beyond"), 0.0)) remedies.push_back(against_friction(run));
  if (remedies.empty() && !is_too_stiff(run) && left_surface_long_ago(run))
    return fmt::format(
        "a hand whose path ends on the surface: the last contact was at {:.4g} s, and the tool moved on "
        "until it was beyond its bounds",
        *run.metric("last_contact_s"));
  if (is_too_stiff(run) || remedies.empty()) remedies.emplace_back("a shorter time.step_s or a smaller K");
  return either(remedies) + (run.is_free() ? "; \"hapbench tune\" finds K and zeta" : "");
}

/// Returns the advice for a tool that passed through a surface without touching one of its points.
static std::string against_untouched_surface(const DiagnosedRun& run) {
  const auto spacing = point_distance(run.loaded);
  if (run.tool == nullptr || (spacing && spacing->metres < run.tool->half_width()))
    return "another initial.position_m or tool: the tool passed through the surface without touching one of its points";
  const std::string finer = spacing ? fmt::format("a smaller {} ({} now)", spacing->path, length_text(spacing->metres))
                                    : std::string("a surface with more points");
  return fmt::format("{}: the tool, {} wide, passed between the points of the surface", finer,
                     length_text(2.0 * run.tool->half_width()));
}

/// Returns the advice for a tool that passed through the surface while its loop was unstable. A smaller K would let it
/// sink in deeper.
static std::string against_sinking_when_unstable(const DiagnosedRun& run) {
  std::vector<std::string> remedies = remedies_at_this_stiffness(run);
  if (remedies.empty()) remedies.emplace_back("a smaller hand force together with a smaller K");
  return either(remedies) + ": the rule \"edge\" names the stability limit of K, and a smaller K alone sinks in deeper";
}

std::string against_sinking(const DiagnosedRun& run) {
  const OutcomeFacts& facts = run.observations.facts;
  if (!facts.scale_question.empty()) return "check the sizes: " + facts.scale_question;
  if (facts.began_inside)
    return run.is_free() ? "another initial.position_m: the tool starts inside the environment"
                         : "another motion.position: the script starts inside the environment";
  if (step_exceeds_half_width(run)) return kShorterStep;
  if (!run.is_free()) return "another motion.position, because the script moves the tool there";
  if (pulls_inwards(run)) return correct_pulling_law();
  if (run.observations.in_contact == 0) return against_untouched_surface(run);
  if (is_too_stiff(run)) return against_sinking_when_unstable(run);
  if (const auto advice = against_instability(run)) return *advice;
  return "a larger K or a smaller hand force; if the rule \"soft\" is listed, another algorithm";
}

std::string against_loss(const DiagnosedRun& run) {
  const OutcomeFacts& facts = run.observations.facts;
  if (!facts.scale_question.empty()) return "check the sizes: " + facts.scale_question;
  if (step_exceeds_half_width(run)) return kShorterStep;
  if (run.ended(Outcome::no_contact)) {
    if (run.scenario().rendering.contact_source == kTrace)
      return "check the times of the contact trace (/rendering/contact_source): no contact of the trace fell on a step "
             "of the run";
    if (facts.holding_friction)
      return fmt::format(
          "a hand with a larger stiffness or force: the device's dry friction of {:.3g} N (device.coulomb_N) holds the "
          "handle",
          *facts.holding_friction);
    if (!run.is_free()) return "another motion.position: the script does not lead the tool to the surface";
    return "check environment.scale, initial.position_m and the hand's direction (\"hapbench validate\" prints sizes "
           "and distances); if the tool came nearer until the end of the run, more time.steps";
  }
  if (const auto advice = against_instability(run)) return *advice;
  if (!run.has_hand())
    return "a hand that presses the tool on the surface, or another algorithm: without a hand, only the force of the "
           "law moves the tool";
  return "a hand whose path ends on the surface";
}

std::string against_standstill(const DiagnosedRun& run) {
  const auto* device = run.impedance();
  const bool device_has_friction = device != nullptr && device->coulomb > 0.0;
  std::vector<std::string> remedies;
  // A hand stays at the end of its path. Friction can hold the tool before the end.
  if (run.ended(Outcome::not_dragged) && run.has_warning("short_path")) {
    const char* const longer = "a longer path of the drag (the warning \"short_path\" names where it ends)";
    if (!device_has_friction && !run.scenario().rendering.has_friction()) return longer;
    remedies.emplace_back(longer);
  }
  // A tool that ends without a rendered force is held by the device or led by the hand; the law has no effect.
  const bool is_rendered = !run.observations.last_force.isZero(0.0);
  if (!is_rendered || stiffer_hand_helps(run)) remedies.emplace_back("a stiffer hand");
  if (is_rendered && run.scenario().rendering.has_friction()) remedies.emplace_back("a smaller rendering.friction");
  if (device_has_friction) remedies.emplace_back("a device with a smaller device.coulomb_N");
  if (!is_rendered) return either(remedies);
  return either(remedies) +
         "; \"hapbench compare SCENARIO --algorithms all\" shows with which algorithms the tool moves on";
}

std::string against_long_steps(const DiagnosedRun& run) {
  return run.is_free() ? "a shorter time.step_s or a slower hand" : "a shorter time.step_s or a slower motion.position";
}

std::string against_unstable_stiffness(const DiagnosedRun& run) {
  std::vector<std::string> remedies =
      effective(device_changes(run.scenario()), [&](const auto& change) { return is_below_limit(run, change); });
  remedies.insert(remedies.begin(), "a smaller K");
  return either(remedies) + "; \"hapbench tune\" finds a stable setting";
}

std::string against_unstable_servo(const DiagnosedRun& run) {
  const std::vector<LoopChange> changes = both(device_changes(run.scenario()), hand_changes());
  const std::vector<std::string> remedies = effective(changes, [&](const auto& change) {
    Scenario changed = run.scenario();
    change(changed);
    return unstable_without_wall(changed).empty();
  });
  return (remedies.empty() ? "another device or hand" : either(remedies)) + "; no K helps";
}

std::string against_unstable_loop(const DiagnosedRun& run) {
  const std::vector<LoopChange> changes = both(device_changes(run.scenario()), damping_changes(run.scenario()));
  const std::vector<std::string> remedies =
      effective(changes, [&](const auto& change) { return is_stable_at_some_stiffness(run, change); });
  if (remedies.empty())
    return "another device or hand: no stiffness is stable with a tenth of the time step, or with a tenth or ten times "
           "the damping";
  return either(remedies);
}

std::string against_buzz(const DiagnosedRun& run) {
  return against_roughness(run, "the smallest vibration", "force_rms_above_30Hz_N");
}

std::string against_pops(const DiagnosedRun& run) {
  return against_roughness(run, "the smallest force steps", "settled_force_step_max_N");
}

std::string against_shaking(const DiagnosedRun& run) {
  return against_roughness(run, "the smallest vibration", "vibration_power_above_30Hz_m2_per_s2");
}

std::string against_reduction(const DiagnosedRun&) {
  return "rendering.reduction null (if settled_force_step_max_N is smaller without it: contacts that begin or end "
         "change the kept set, too)";
}

std::string against_coarseness(const DiagnosedRun& run) {
  // Half of the spacing gives four times as many points, or twice as many on the outline of a planar hole. If the
  // rendered stiffness grows with their number, K must be smaller by this factor. Stiffness shaping keeps the ratio
  // below 1.5.
  constexpr double kGrowsWithPoints = 1.5;
  const bool grows = is_beyond(run.metric("ratio_max"), kGrowsWithPoints);
  const char* const part = std::holds_alternative<Hole2d>(run.scenario().environment) ? "half" : "a quarter";
  const std::string of_K =
      grows ? fmt::format(" and {} of K, because the stiffness of this algorithm grows with the number of points", part)
            : "";
  return fmt::format("half of {}{}; \"hapbench compare --errors\" shows which metrics depend on it",
                     point_distance(run.loaded)->path, of_K);
}

std::string against_depth(const DiagnosedRun& run) {
  const OutcomeFacts& facts = run.observations.facts;
  if (!facts.scale_question.empty()) return "check the sizes: " + facts.scale_question;
  if (!run.is_free()) return "another motion.position, because the script moves the tool there";
  if (is_beyond(saturation(run), kMaxSaturation)) return "a smaller hand force: the rendered force is at its limit";
  if (is_beyond(softness(run), kMaxSoftness)) return laws_that_never_soften(run);
  if (is_too_stiff(run)) return "a smaller hand force: K is already near its stability limit";
  return "a larger K, or a smaller hand force if \"hapbench tune --bound inside_max_m=3e-4\" finds no stable K that "
         "keeps this depth";
}

std::string against_softness(const DiagnosedRun& run) {
  return laws_that_never_soften(run);
}

std::string against_sums(const DiagnosedRun& run) {
  return fmt::format("K / {:.3g}, or an algorithm that does not add up the stiffnesses of the contacts, such as {}",
                     *run.metric("ratio_max"), other_laws(run, {"shaped_stiffness", "mean"}));
}

std::string against_damping(const DiagnosedRun& run) {
  std::vector<std::string> remedies = {"a smaller " + damping_field(run.scenario().rendering), "a shorter time.step_s"};
  if (run.scenario().rendering.max_damping) remedies.emplace_back("a smaller rendering.limits.max_damping_N_s_per_m");
  return either(remedies);
}

std::string against_friction(const DiagnosedRun&) {
  return R"(a smaller rendering.friction.mu_f_s_per_m, rendering.friction {"type": "dry"}, or a shorter time.step_s)";
}

std::string against_encoder(const DiagnosedRun& run) {
  const auto* filter = std::get_if<LowPassFilter>(&run.impedance()->velocity_filter);
  constexpr double kUsualCutoff = 300.0;  // divided by the factors of effective(): 30 and 100 Hz
  const auto smooth = [](Scenario& s, double factor) {
    auto& device = std::get<ImpedanceDeviceConfig>(s.device);
    const auto* low_pass = std::get_if<LowPassFilter>(&device.velocity_filter);
    LowPassFilter smoother = low_pass != nullptr ? *low_pass : LowPassFilter{};
    smoother.cutoff = (low_pass != nullptr ? low_pass->cutoff : kUsualCutoff) / factor;
    device.velocity_filter = smoother;
  };
  const std::vector<LoopChange> changes = {
      {"a smaller " + damping_field(run.scenario().rendering),
       [](Scenario& s, double factor) { scale_damping(s.rendering, 1.0 / factor, 0.0); }},
      {filter != nullptr ? "a lower cutoff_Hz of device.velocity_filter" : "a low-pass device.velocity_filter",
       smooth}};
  // Less damping, and the delay of a filter, may make a stable loop unstable.
  const bool is_stable = run.is_free() && is_below_limit(run, [](Scenario&) {});
  std::vector<std::string> remedies =
      effective(changes, [&](const auto& change) { return !is_stable || is_below_limit(run, change); });
  remedies.insert(remedies.begin(), "a finer encoder");
  return either(remedies);
}

std::string against_inward_force(const DiagnosedRun&) {
  return "if the law is not meant to attract: weights above 0, or a force of -K times depth times gradient, summed "
         "over the contacts";
}

std::string against_saturation(const DiagnosedRun& run) {
  const auto& rendered = run.scenario().rendering.max_force;
  const ImpedanceDeviceConfig* device = run.impedance();
  const bool device_binds = device != nullptr && device->force_max && (!rendered || *device->force_max <= *rendered);
  const std::string limit = device_binds ? "a stronger device" : "a larger rendering.limits.max_force_N";
  if (!run.is_free()) return either({"a smaller K", "a motion.position that is less deep", limit});
  if (const auto advice = against_instability_at_any_stiffness(run)) return *advice;
  // In equilibrium, the rendered force balances the hand's force at any K. A smaller K therefore helps only against
  // vibration.
  return is_too_stiff(run) || run.vibrates() ? either({"a smaller K", "a smaller hand force", limit})
                                             : either({"a smaller hand force", limit});
}

std::string against_input_limit(const DiagnosedRun& run) {
  if (const auto advice = against_instability_at_any_stiffness(run)) return *advice;
  return "a smaller hand force, or a larger device.force_limit_N (f_th in section 2.7 of the thesis)";
}

std::string against_bounces(const DiagnosedRun& run) {
  if (const auto advice = against_instability_at_any_stiffness(run)) return *advice;
  if (is_too_stiff(run)) return "a smaller K";
  const std::string field = damping_field(run.scenario().rendering);
  return is_beyond(damping_share(run), kMaxDampingShare) ? "a smaller " + field
                                                         : "a larger " + field + " or a smaller K";
}

std::string against_chatter(const DiagnosedRun& run) {
  return against_roughness(run, "the fewest force reversals", "force_reversals_per_s");
}

std::string against_energy(const DiagnosedRun& run) {
  if (const auto advice = against_instability_at_any_stiffness(run)) return *advice;
  if (const auto* device = run.impedance()) {
    // If the rendered force alone creates no energy, the delay creates it.
    const bool delay_creates = device->delay_samples > 0.0 && is_beyond(created_energy(run), kMaxCreatedEnergy) &&
                               !is_beyond(run.metric("passivity.net_created_J"), kMaxCreatedEnergy);
    return delay_creates ? "a shorter delay of the device, or a smaller K" : "a smaller K";
  }
  return run.scenario().rendering.passivity_controller ? "a smaller K"
                                                       : "a smaller K, or rendering.passivity_controller, which is off";
}

std::string against_reversed_force(const DiagnosedRun&) {
  return "\"hapbench import stroke --set force_by_tool=true\", which reverses the measured force; if its sign is "
         "right, the "
         "orientation of the tool or the normals of the surface may be reversed";
}

std::string against_drift(const DiagnosedRun& run) {
  if (run.scenario().rendering.dry_friction)
    return "a larger rendering.friction.mu, with which friction holds the tool";
  return "rendering.friction {\"type\": \"dry\"} with a sufficiently large mu; viscous friction cannot hold a tool";
}

}  // namespace hapbench
