#include "scenarios/scene/hands.hpp"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "device_model/hands/drag_hand.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "device_model/hands/tracking_hand.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/motions.hpp"
#include "scenarios/scene/profiles.hpp"

namespace hapbench {

constexpr NumberRange kCoordinate = {-1000.0, 1000.0, "m"};
constexpr NumberRange kAngle = {-6.3, 6.3, "rad"};  ///< a full turn in both directions

static void describe(Fields& f, ForceHandFields& hand) {
  profiles(f, {"x_N", "y_N", "z_N"}, hand.force, "N", "force on the handle over time");
}

static void describe(Fields& f, PushHandFields& hand) {
  profile(f, "force_N", hand.force, "N", "force on the handle over time", Presence::required);
  f.number("angle_rad", hand.angle, kAngle, "of the force from straight down, -z; 3-D scenes only");
  f.number("azimuth_rad", hand.azimuth, kAngle, "of its lean, from +x about z");
}

static void describe(Fields& f, TremorConfig& tremor) {
  f.vector3(
      "rms_m", tremor.rms, {0.0, 0.1, "m"},
      "standard deviation of each axis; 30e-6 of a resting finger, up to 5 times that with the arm held out (Growdon "
      "et al. 2000)");
  f.number("low_Hz", tremor.low, {0.0, 1000.0, "Hz"}, "lower end of its band (Novak and Newell 2017)");
  f.number("high_Hz", tremor.high, {0.0, 1000.0, "Hz"}, "upper end of its band");
  if (f.reads() && tremor.low > tremor.high) fail_at(f.at() + "/high_Hz", "allowed: low_Hz or more");
}

static void describe(Fields& f, ImpedanceHandFields& hand) {
  f.number("stiffness_N_per_m", hand.stiffness, {0.0, 1e9, "N/m"}, "of the spring from target to handle");
  f.number("damping_N_s_per_m", hand.damping, {0.0, 1e9, "N s/m"}, "of the damper parallel to it");
  f.group("target", "where the hand wants the handle", Presence::required, [&hand](Fields& t) {
    profiles(t, {"x_m", "y_m", "z_m"}, hand.target, "m", "over time", Presence::required);
  });
  f.object_if_any("tremor", hand.tremor,
                  "how the target trembles besides, by the scenario's seed; without it the hand rests ideally");
}

static void describe(Fields& f, MassSpringDamperHandFields& hand) {
  f.number("mass_kg", hand.mass, {0.0, 1e6, "kg"}, "of the hand, fixed to the handle (ours)");
  describe(f, hand.spring);
}

static void describe(Fields& f, DragHandFields& hand) {
  Drag& drag = hand.drag;
  profile(f, "force_N", drag.force, "N", "along the inward normal of the surface, over time");
  f.if_any("path_m", hand.path, "way of the tool over the surface, straight legs between points on or near it",
           [](Fields& path, std::vector<Vec3>& points) {
             path.list(points, {2, 10'000}, [](Fields& p, Vec3& point) { p.vector3(point, kCoordinate); });
           });
  f.if_any("direction", hand.direction,
           "instead of path_m: from initial.position on along this direction within the surface, to its edge",
           [](Fields& d, Vec3& direction) {
             d.vector3(direction, {-1e9, 1e9, "1"});
           });
  f.exactly_one_of("path_m", "direction");
  f.number("speed_m_per_s", drag.speed, {0.0, 100.0, "m/s", true}, "along the path");
  f.number("tilt_rad", hand.tilt, kAngle,
           "of the axis from the normal, towards the direction of travel; null: motion.orientation turns the tool");
  f.number("azimuth_rad", hand.azimuth, kAngle, "turns that lean from the direction of travel, about the normal");
  f.number("stiffness_N_per_m", drag.stiffness, {0.0, 1e9, "N/m"}, "within the surface, towards the moving point");
  f.number("damping_N_s_per_m", drag.damping, {0.0, 1e9, "N s/m"}, "within the surface, parallel to that spring");
  f.number("normal_damping_N_s_per_m", drag.normal_damping, {0.0, 1e9, "N s/m"},
           "along the normal; the tool is lowered at force_N / normal_damping_N_s_per_m");
  f.number("smoothing_m", hand.smoothing, {0.0, 1000.0, "m", true},
           "radius over which the hand feels place and normal of the surface");
}

static void describe(Fields& f, Gauge& gauge) {
  f.number("cutoff_Hz", gauge.cutoff, {0.0, 1e6, "Hz", true}, "of the low-pass of the spring force it shows");
  f.number("grace_s", gauge.grace, {0.0, 1000.0, "s"},
           "how long it may show less than least_press_N without a break of the hold; without effect together with "
           "threshold");
}

static void describe(Fields& f, Threshold& threshold) {
  f.choice("force", threshold.force, {"rendered", "spring"}, "force", "whose component along +z counts");
  f.number("cutoff_Hz", threshold.cutoff, {0.0, 1e6, "Hz", true},
           "of a first-order low-pass; null: every sample counts");
  f.number("grace_s", threshold.grace, {0.0, 1000.0, "s"},
           "how long it may be less than least_press_N without a break of the hold");
  f.choice("low", threshold.low, {"restarts", "pauses", "closes", "nothing"}, "effect",
           "of a longer dip: the hold restarts, or pauses, the target closes, or nothing");
}

static void describe(Fields& f, TargetRules& task) {
  f.choice("display", task.display, {"panel", "height"}, "display",
           "panel: x and y count, the orientation is scripted; height: z counts, the hand turns the tool");
  f.list(
      "places_m", task.places, {1, TrackingHandFields::kMostPlaces}, "where targets appear",
      [](Fields& p, Vec3& position) { p.vector3(position, kCoordinate); }, Presence::required);
  f.integer("targets_per_place", task.targets_per_place, {1, 1000}, "in one trial");
  f.number("tolerance_m", task.tolerance, {0.0, 1.0, "m", true}, "the tip is on the target within this distance");
  f.number("logged_m", task.logged, {0.0, 1.0, "m", true},
           "model force and speed are means over the rows within this distance of the target; null: tolerance_m");
  f.number("least_press_N", task.least_press, {0.0, 1000.0, "N"},
           "force along +z that activates the task and must last while it is held");
  f.object("gauge", task.gauge, "a display of the spring force; null: the rendered force, every sample of it");
  f.object("threshold", task.threshold,
           "what the task checks against least_press_N, apart from what the gauge shows; null: what the gauge shows");
  f.number("hold_s", task.hold, {0.0, 1000.0, "s", true}, "time on the target, without a break, that removes it");
  f.number("time_limit_s", task.time_limit, {0.0, 1000.0, "s", true},
           "from the activation until the target disappears");
}

static void describe(Fields& f, Subject& subject) {
  f.number("reaction_delay_s", subject.reaction_delay, {0.0, 10.0, "s"}, "from the display to the hand (ours)");
  f.number("bandwidth_Hz", subject.bandwidth, {0.0, 100.0, "Hz"}, "of following the target on the display (ours)");
  f.number("stiffness_N_per_m", subject.stiffness, {1.0, 1e6, "N/m"}, "of the hand about its intended position (ours)");
  f.number("damping_N_s_per_m", subject.damping, {0.0, 1e6, "N s/m"}, "of the hand (ours)");
  f.number("press_N", subject.press, {0.0, 1000.0, "N"}, "force the subject wants to see on the gauge (ours)");
  f.number("press_bandwidth_Hz", subject.press_bandwidth, {0.0, 100.0, "Hz"}, "of correcting it (ours)");
  f.number("motor_noise_N", subject.motor_noise, {0.0, 1000.0, "N"},
           "standard deviation of each force component (ours)");
  f.number("tilt_noise_rad", subject.tilt_noise, {0.0, 1.0, "rad"},
           "standard deviation of the tilt, where the wrist turns the tool (ours)");
  f.number("noise_bandwidth_Hz", subject.noise_bandwidth, {0.0, 1e4, "Hz"}, "of both noises, first order (ours)");
  f.number("height_per_tilt_m_per_rad", subject.height_per_tilt, {1e-6, 1.0, "m/rad"},
           "how much the subject expects the tip to rise with the tilt (ours)");
  f.number("max_speed_m_per_s", subject.max_speed, {0.0, 100.0, "m/s"}, "of the intended position (ours)");
  f.number("max_turn_rad_per_s", subject.max_turn, {0.0, 100.0, "rad/s"}, "of the wrist (ours)");
  f.number("max_force_N", subject.max_force, {0.0, 1000.0, "N"}, "the arm yields rather than push harder (ours)");
}

static void describe(Fields& f, TrackingHandFields& hand) {
  f.object("task", hand.task, "targets and rules of a trial", Presence::required);
  f.objects("subjects", hand.subjects, {1, 1000}, "simulated subjects");
  f.integer("trials", hand.trials, {1, 1000}, "of each subject, each from the initial state with a seed of its own");
}

void describe(Fields& f, HandFields& hand) {
  f.variant(hand, "hand",
            {{"none", "nobody: the tool moves by the rendered force alone"},
             {"force", "a force over time"},
             {"push", "a force over time along a direction that leans from straight down"},
             {"impedance", "a spring and damper towards a moving target"},
             {"drag", "leads the tool over the surface, pressing along its normal"},
             {"tracking", "a simulated subject who follows targets on a display"},
             {"mass_spring_damper", "a passive hand fixed to the handle of an impedance device"}});
}

namespace {

std::unique_ptr<TrackingHand> make_tracking_hand(const Scenario& scenario, const TrackingHandFields& fields,
                                                 Trial trial) {
  // The order of targets depends only on the scenario's seed and the trial. Therefore a subject gets the same order
  // with every algorithm.
  return std::make_unique<TrackingHand>(fields.subjects[trial.subject],
                                        TargetTask(fields.task, derived_seed(scenario, trial, RandomUse::target_order)),
                                        scenario.motion.orientation->tilt(0.0), scenario.time.step,
                                        derived_seed(scenario, trial, RandomUse::motor_noise));
}

/// Sets the hand and, if the hand controls the tilt, the motion. Precondition: parts.shell is set.
void add_drag(const Scenario& scenario, const DragHandFields& fields, SimulationParts& parts) {
  // Compute the path over the surface: through given points or along a direction.
  const SmoothedSurface surface(*parts.shell, fields.smoothing);
  const double length = fields.drag.speed * static_cast<double>(scenario.time.steps) * scenario.time.step;
  const auto path = std::make_shared<const SurfacePath>(
      fields.path ? SurfacePath::over(surface, *fields.path)
                  : SurfacePath::along(surface, scenario.initial.position, *fields.direction, length));
  // Create the hand, which follows the path.
  parts.hand = std::make_unique<DragHand>(fields.drag, path);
  if (fields.tilt)
    parts.motion = std::make_unique<DragOrientation>(path, fields.drag.speed, *fields.tilt, fields.azimuth);
}

}  // namespace

void add_hand_and_motion(const Scenario& scenario, const NamedFiles& files, Trial trial, SimulationParts& parts) {
  if (const auto* tracking = std::get_if<TrackingHandFields>(&scenario.hand)) {
    auto hand = make_tracking_hand(scenario, *tracking, trial);
    if (tracking->task.display == TargetDisplay::height)
      parts.motion = std::make_unique<HeldOrientation>(make_orientation(*scenario.motion.orientation), *hand);
    parts.hand = std::move(hand);
  } else if (const auto* drag = std::get_if<DragHandFields>(&scenario.hand)) {
    add_drag(scenario, *drag, parts);
  } else if (const auto* force = std::get_if<ForceHandFields>(&scenario.hand)) {
    parts.hand = std::make_unique<ForceHand>(force->force);
  } else if (const auto* push = std::get_if<PushHandFields>(&scenario.hand)) {
    parts.hand = std::make_unique<PushHand>(push->force, push_direction(push->angle, push->azimuth));
  } else if (const ImpedanceHandFields* spring = spring_of(scenario.hand)) {
    std::optional<Tremor> tremor;
    if (spring->tremor) tremor.emplace(*spring->tremor, derived_seed(scenario, trial, RandomUse::tremor));
    parts.hand = std::make_unique<ImpedanceHand>(spring->stiffness, spring->damping, spring->target, tremor);
  } else {
    parts.hand = std::make_unique<ForceHand>();
  }
  // The hand does not control the orientation: use the scripted or recorded motion.
  if (!parts.motion) parts.motion = make_motion(scenario, files);
}

}  // namespace hapbench
