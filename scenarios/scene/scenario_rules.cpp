#include "scenarios/scene/scenario_rules.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>
#include <variant>

#include "algorithms/proxy/turning_proxy.hpp"
#include "device_model/hands/drag_hand.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/scene/field_checks.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

constexpr double kMaxDelaySamples = 1e6;  ///< maximum reaction delay of a simulated subject [time steps]
constexpr double kMaxPathEntries = 1e6;   ///< maximum number of samples of a drag hand's path

/// Throws InputError if the run has too many steps, recorded rows or timed steps.
void check_sizes(const Scenario& scenario, double steps) {
  if (!(steps >= 1.0 && steps <= kMaxSteps)) {
    fail_at("/time/duration_s",
            fmt::format("got {:.3g} steps (duration_s / step_s); allowed: 1 ... {:.0g}", steps, kMaxSteps));
  }
  const double rows = steps / static_cast<double>(scenario.record.every);
  if (records_rows(scenario.record) && rows > kMaxRows) {
    fail_at("/record/every",
            fmt::format(
                "got {:.3g} recorded rows; allowed: at most {:.0g}; record fewer steps (record.every) or fewer files",
                rows, kMaxRows));
  }
  // The measured times of all steps of all trials are kept in memory.
  if (scenario.record.timing)
    require_at_most(kMaxRows, steps * trial_count(scenario.hand), "/record/timing", "timed steps");
}

/// Throws InputError if the motion has an orientation whose `up` and `lean` are not perpendicular or are zero.
void check_orientation(const MotionFields& motion) {
  if (!motion.orientation) return;
  const Vec3 &up = motion.orientation->up, &lean = motion.orientation->lean;
  // The tolerance of 1e-9 allows for directions that are rounded in the file.
  if (up.norm() >= kMinDirectionNorm && lean.norm() >= kMinDirectionNorm &&
      std::abs(up.dot(lean)) <= 1e-9 * up.norm() * lean.norm())
    return;
  fail_at("/motion/orientation", fmt::format("got up {} and lean {}; allowed: two perpendicular directions, not zero",
                                             shown(up), shown(lean)));
}

template <class Type, class Variant>
bool is(const Variant& value) {
  return std::holds_alternative<Type>(value);
}

bool is_zero(const Profile& profile) {
  return profile.is_constant() && profile(0.0) == 0.0;
}

constexpr const char* kTurningProxy = "/rendering/parameters/proxy/rotational_stiffness_N_m_per_rad";
bool is_rigid_contact(const Scenario& s) {
  return s.reference_force && std::holds_alternative<RigidContactFields>(*s.reference_force);
}

/// A combination of fields that is rejected.
struct Rule {
  const char* at;       ///< JSON pointer of the field that the error names
  const char* problem;  ///< message; "{}" stands for rendering.contact_source
  bool (*is_broken)(const Scenario& scenario);
};

/// The rules in the order in which they are checked. The condition of a rule may assume that all earlier rules are
/// satisfied.
constexpr Rule kRules[] = {
    {"/rendering/local_average", "got true; allowed: false, because springs have no grid cells",
     [](const Scenario& s) { return s.rendering.local_average && is<SpringsEnvironment>(s.environment); }},
    {"/rendering/local_average", "got true; allowed: false, unless environment.grid_m gives the cells",
     [](const Scenario& s) {
       const auto* shell = std::get_if<PointShellEnvironment>(&s.environment);
       const auto* mesh = std::get_if<MeshEnvironment>(&s.environment);
       return s.rendering.local_average && ((shell != nullptr && !shell->grid) || (mesh != nullptr && !mesh->grid));
     }},
    {"/record/ideal_trajectory",
     "got true; allowed: false, unless the environment is block_with_hole and the tool a cylinder with a flat tip",
     [](const Scenario& s) {
       const auto* cylinder = std::get_if<CylinderFields>(&s.tool);
       const bool is_flat = cylinder != nullptr && cylinder->tip == Tip::flat;
       return s.record.ideal_trajectory && !(is<BlockEnvironment>(s.environment) && is_flat);
     }},
    {"/integrator/tolerance_s", "allowed for integrator.type \"event\" only",
     [](const Scenario& s) { return s.integrator.type != &kEvent && s.integrator.tolerance != kEventTolerance; }},
    {"/reference_force",
     "contradicts motion.position of type \"free\"; allowed: a prescribed position, or a reference_force of type "
     "\"rigid_contact\" with a hand of type \"impedance\" or \"mass_spring_damper\" without tremor",
     [](const Scenario& s) {
       const ImpedanceHandFields* spring = spring_of(s.hand);
       const bool is_led = is_rigid_contact(s) && spring != nullptr && !spring->tremor;
       return s.reference_force && is<FreePosition>(s.motion.position) && !is_led;
     }},
    {"/reference_force/type",
     "got \"rigid_contact\"; allowed with environment.type \"mesh\", whose triangles it touches",
     [](const Scenario& s) { return is_rigid_contact(s) && !is<MeshEnvironment>(s.environment); }},
    {"/reference_force/type",
     "got \"rigid_contact\"; allowed with a tool of type cylinder with tip \"round\": for flat tips, and tools of the "
     "types revolved, bur and mesh, this reference does not exist",
     [](const Scenario& s) {
       const auto* cylinder = std::get_if<CylinderFields>(&s.tool);
       return is_rigid_contact(s) && (cylinder == nullptr || cylinder->tip != Tip::round);
     }},
    {"/record/force_reference",
     "got true; allowed: false, unless there is a reference_force or motion.position is of type \"file\"",
     [](const Scenario& s) {
       return s.record.force_reference && !s.reference_force && !is<RecordedPosition>(s.motion.position);
     }},
    {"/six_dof",
     "contradicts motion.position of type \"free\"; allowed: a prescribed motion, which is the intended motion of the "
     "hand",
     [](const Scenario& s) { return s.six_dof && is<FreePosition>(s.motion.position); }},
    {"/six_dof",
     "got the environment springs or hole_2d, which do not resist a rotation of the tool; allowed: an environment with "
     "a surface in space",
     [](const Scenario& s) {
       return s.six_dof && (is<SpringsEnvironment>(s.environment) || is<Hole2d>(s.environment));
     }},
    {"/six_dof", "got rendering.contact_source \"{}\"; allowed: \"own\"",
     [](const Scenario& s) { return s.six_dof && has_external_contacts(s); }},
    {"/six_dof", "got rendering.stiffness_N_per_m 0; allowed: > 0, because it is the stiffness of the coupling",
     [](const Scenario& s) { return s.six_dof && s.rendering.stiffness == 0.0; }},
    {"/record/six_dof", "got true; allowed: false, unless the scenario has the field six_dof",
     [](const Scenario& s) { return s.record.six_dof && !s.six_dof; }},
    {kTurningProxy, "got a number with springs, which act at the tip centre and cannot rotate the proxy; allowed: null",
     [](const Scenario& s) { return turns(s.rendering) && is<SpringsEnvironment>(s.environment); }},
    {kTurningProxy, "got a number with multi-rate contacts (rendering.contacts); allowed: null",
     [](const Scenario& s) { return turns(s.rendering) && s.rendering.multi_rate && s.rendering.multi_rate->any(); }},
    {kTurningProxy, "got a number with rendering.angular_damping; allowed: null",
     [](const Scenario& s) { return turns(s.rendering) && s.rendering.angular_damping; }},
    {kTurningProxy, "got a number with a damping_time_s; allowed: null",
     [](const Scenario& s) {
       const auto own = s.rendering.parameters.find("proxy");
       return turns(s.rendering) && own->second.contains("damping_time_s") && own->second.at("damping_time_s") > 0.0;
     }},
    {"/hand/type", "got \"push\", which pushes along z; allowed in the plane of \"hole_2d\": \"force\"",
     [](const Scenario& s) { return is<PushHandFields>(s.hand) && is<Hole2d>(s.environment); }},
    {"/hand/type", "got \"drag\" with springs, which have no surface; allowed: environments with a surface",
     [](const Scenario& s) { return is<DragHandFields>(s.hand) && is<SpringsEnvironment>(s.environment); }},
    {"/motion/position/type", "got a prescribed position; allowed: \"free\" with hand \"drag\", which moves the tool",
     [](const Scenario& s) { return is<DragHandFields>(s.hand) && !is<FreePosition>(s.motion.position); }},
    {"/motion/orientation",
     "got tilt_rad, azimuth_rad or roll_rad together with hand \"drag\", which rotates the tool; allowed: none of "
     "these fields, or hand.tilt_rad null",
     [](const Scenario& s) {
       const auto* drag = std::get_if<DragHandFields>(&s.hand);
       if (drag == nullptr || !drag->tilt) return false;
       const OrientationFields& orientation = *s.motion.orientation;
       return !(is_zero(orientation.tilt) && is_zero(orientation.azimuth) && is_zero(orientation.roll));
     }},
    {"/motion/position/type",
     "got a prescribed position; allowed: \"free\" with hand \"tracking\", which moves the tool",
     [](const Scenario& s) { return is<TrackingHandFields>(s.hand) && !is<FreePosition>(s.motion.position); }},
    // Recorded contacts are valid for the recorded motion only. Recorded contacts, and contacts that a loaded module
    // (a shared library) computes, are not points of the scenario's point shell.
    {"/rendering/contact_source", "got \"{}\"; allowed: \"own\", with springs, which have no surface",
     [](const Scenario& s) { return has_external_contacts(s) && is<SpringsEnvironment>(s.environment); }},
    {"/rendering/contact_source",
     "got \"{}\"; allowed: \"own\", unless motion.position is prescribed, as it was when the contacts were recorded",
     [](const Scenario& s) {
       return s.rendering.contact_source == kTrace && (position_is_free(s.motion) || handle_moves_tool(s.device));
     }},
    {"/rendering/contact_source", "got \"{}\"; allowed: \"own\", with local_average, which merges shell points",
     [](const Scenario& s) { return has_external_contacts(s) && s.rendering.local_average; }},
    {"/rendering/contact_source",
     "got \"{}\"; allowed: \"own\", with reduction.shuffle_seed, which orders shell points",
     [](const Scenario& s) {
       return has_external_contacts(s) && s.rendering.reduction && s.rendering.reduction->shuffle_seed;
     }},
    // Rules of an impedance device, which has no virtual mass between hand and tool.
    {"/hand/type",
     "got \"mass_spring_damper\", which is fixed to the handle of device \"impedance\"; allowed with other devices: "
     "\"impedance\", the same spring and damper without the mass",
     [](const Scenario& s) { return is<MassSpringDamperHandFields>(s.hand) && !handle_moves_tool(s.device); }},
    {"/motion/position/type",
     "got a prescribed position; allowed: \"free\" with device \"impedance\", whose handle moves the tool",
     [](const Scenario& s) { return handle_moves_tool(s.device) && !is<FreePosition>(s.motion.position); }},
    {"/rendering/passivity_controller",
     "got true; allowed: false with device \"impedance\": the controller predicts the motion of a virtual mass, which "
     "this device does not have",
     [](const Scenario& s) { return handle_moves_tool(s.device) && s.rendering.passivity_controller; }},
    {"/rendering/force_stage/max_damping_N_s_per_m",
     "got null; allowed with device \"impedance\" or a prescribed position: a number, because there is no virtual mass "
     "that determines the default",
     [](const Scenario& s) {
       const bool has_mass = is<FreePosition>(s.motion.position) && !handle_moves_tool(s.device);
       if (has_mass || !s.rendering.force_stage) return false;
       const auto* limited = std::get_if<ActuatorLimitedPassivityConfig>(&*s.rendering.force_stage);
       return limited != nullptr && !limited->max_damping;
     }},
};

/// Throws InputError if the drag hand's direction is zero or its path has too many samples.
void check_drag_hand(const Scenario& scenario, double steps) {
  const auto* hand = std::get_if<DragHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  if (hand->direction) require_direction(*hand->direction, "/hand/direction");
  const double entries = drag_length(*hand, steps * scenario.time.step) / SurfacePath::spacing(hand->smoothing);
  if (entries <= kMaxPathEntries) return;
  fail_at("/hand/smoothing_m",
          fmt::format("got a path {:.3g} times as long as a tenth of smoothing_m; allowed: at most {:.0g} times",
                      entries, kMaxPathEntries));
}

/// Throws InputError if a subject's reaction delay or the total number of steps is too large.
void check_tracking_hand(const Scenario& scenario, double steps) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return;
  for (std::size_t i = 0; i < hand->subjects.size(); ++i)
    require_at_most(kMaxDelaySamples, hand->subjects[i].reaction_delay / scenario.time.step,
                    fmt::format("/hand/subjects/{}/reaction_delay_s", i), "time steps");
  require_at_most(kMaxSteps, trial_count(scenario.hand) * steps, "/hand/trials", "steps in all trials");
}

}  // namespace

void check_relations(const Scenario& scenario, double steps) {
  check_sizes(scenario, steps);
  check_orientation(scenario.motion);
  for (const Rule& rule : kRules) {
    if (rule.is_broken(scenario))
      fail_at(rule.at, fmt::format(fmt::runtime(rule.problem), scenario.rendering.contact_source));
  }
  check_drag_hand(scenario, steps);
  check_tracking_hand(scenario, steps);
}

}  // namespace hapbench
