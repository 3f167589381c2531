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
/// Range of angles: a little more than one full turn in both directions.
constexpr NumberRange kAngle = {-6.3, 6.3, "rad"};

static void describe(Fields& f, ForceHandFields& hand) {
  profiles(f, {"x_N", "y_N", "z_N"}, hand.force, "N",
           "component of the hand's force on the handle, as a function of time");
}

static void describe(Fields& f, PushHandFields& hand) {
  profile(f, "force_N", hand.force, "N", "magnitude of the hand's force on the handle, as a function of time",
          Presence::required);
  f.number("angle_rad", hand.angle, kAngle, "angle of the force from straight down (-z); 3-D scenes only");
  f.number("azimuth_rad", hand.azimuth, kAngle, "direction in which the force leans, as an angle from +x about z");
}

static void describe(Fields& f, TremorConfig& tremor) {
  f.vector3(
      "rms_m", tremor.rms, {0.0, 0.1, "m"},
      "standard deviation of the tremor along each axis; 30e-6 for a resting finger, up to 5 times as much with the "
      "arm held out (Growdon et al. 2000)");
  f.number("low_Hz", tremor.low, {0.0, 1000.0, "Hz"},
           "lower end of the tremor's frequency band (Novak and Newell 2017)");
  f.number("high_Hz", tremor.high, {0.0, 1000.0, "Hz"}, "upper end of the tremor's frequency band");
  if (f.reads() && tremor.low > tremor.high) fail_at(f.at() + "/high_Hz", "allowed: low_Hz or more");
}

static void describe(Fields& f, ImpedanceHandFields& hand) {
  f.number("stiffness_N_per_m", hand.stiffness, {0.0, 1e9, "N/m"}, "stiffness of the spring between target and handle");
  f.number("damping_N_s_per_m", hand.damping, {0.0, 1e9, "N s/m"}, "damping of the damper parallel to this spring");
  f.group("target", "target of the hand: position to which its spring pulls the handle", Presence::required,
          [&hand](Fields& t) {
            profiles(t, {"x_m", "y_m", "z_m"}, hand.target, "m", "coordinate of the target, as a function of time",
                     Presence::required);
          });
  f.object_if_any("tremor", hand.tremor,
                  "tremor added to the target, random by the scenario's seed; without it the target is free of noise");
}

static void describe(Fields& f, MassSpringDamperHandFields& hand) {
  f.number("mass_kg", hand.mass, {0.0, 1e6, "kg"}, "mass of the hand, fixed to the handle (our assumption)");
  describe(f, hand.spring);
}

static void describe(Fields& f, DragHandFields& hand) {
  Drag& drag = hand.drag;
  profile(f, "force_N", drag.force, "N",
          "force with which the hand presses along the inward normal of the surface, as a function of time");
  f.if_any("path_m", hand.path, "path of the tool over the surface: straight segments between points on or near it",
           [](Fields& path, std::vector<Vec3>& points) {
             path.list(points, {2, 10'000}, [](Fields& p, Vec3& point) { p.vector3(point, kCoordinate); });
           });
  f.if_any(
      "direction", hand.direction,
      "direction of the path within the surface, from initial.position to the edge of the surface; in place of path_m",
      [](Fields& d, Vec3& direction) {
        d.vector3(direction, {-1e9, 1e9, "1"});
      });
  f.exactly_one_of("path_m", "direction");
  f.number("speed_m_per_s", drag.speed, {0.0, 100.0, "m/s", true}, "speed along the path");
  f.number(
      "tilt_rad", hand.tilt, kAngle,
      "angle of the tool's axis from the surface normal, towards the direction of travel; null: motion.orientation "
      "gives the orientation");
  f.number("azimuth_rad", hand.azimuth, kAngle, "rotation of this tilt about the normal, from the direction of travel");
  f.number("stiffness_N_per_m", drag.stiffness, {0.0, 1e9, "N/m"},
           "stiffness of the spring that pulls the tool within the surface to the moving point of the path");
  f.number("damping_N_s_per_m", drag.damping, {0.0, 1e9, "N s/m"},
           "damping within the surface, parallel to this spring");
  f.number("normal_damping_N_s_per_m", drag.normal_damping, {0.0, 1e9, "N s/m"},
           "damping along the normal; without contact the hand lowers the tool at the speed force_N / "
           "normal_damping_N_s_per_m");
  f.number("smoothing_m", hand.smoothing, {0.0, 1000.0, "m", true},
           "radius over which position and normal of the surface are averaged for the hand");
}

static void describe(Fields& f, Gauge& gauge) {
  f.number("cutoff_Hz", gauge.cutoff, {0.0, 1e6, "Hz", true},
           "cutoff frequency of the low-pass of the displayed spring force");
  f.number(
      "grace_s", gauge.grace, {0.0, 1000.0, "s"},
      "longest time for which the displayed force may be below min_press_N without interrupting the hold; no effect "
      "if threshold is given");
}

static void describe(Fields& f, Threshold& threshold) {
  f.choice("force", threshold.force, {"rendered", "spring"}, "force",
           "force whose component along +z is compared with min_press_N");
  f.number("cutoff_Hz", threshold.cutoff, {0.0, 1e6, "Hz", true},
           "cutoff frequency of a first-order low-pass of this force; null: unfiltered");
  f.number("grace_s", threshold.grace, {0.0, 1000.0, "s"},
           "longest time for which the force may be below min_press_N without interrupting the hold");
  f.choice(
      "low", threshold.low, {"restarts", "pauses", "closes", "nothing"}, "effect",
      "effect of a longer interruption: the hold restarts, the hold pauses, the target closes, or nothing happens");
}

static void describe(Fields& f, TargetRules& task) {
  f.choice(
      "display", task.display, {"panel", "height"}, "display",
      "panel: the target has x and y, and the orientation is scripted; height: the target has z, and the hand turns "
      "the tool");
  f.list(
      "places_m", task.positions, {1, TrackingHandFields::kMaxTargetPositions}, "positions at which targets appear",
      [](Fields& p, Vec3& position) { p.vector3(position, kCoordinate); }, Presence::required);
  f.integer("targets_per_place", task.targets_per_position, {1, 1000}, "number of targets per position in one trial");
  f.number("tolerance_m", task.tolerance, {0.0, 1.0, "m", true}, "distance within which the tip is on the target");
  f.number("logged_m", task.logged, {0.0, 1.0, "m", true},
           "distance within which steps count for the mean model force and speed at a target; null: tolerance_m");
  f.number("min_press_N", task.min_press_force, {0.0, 1000.0, "N"},
           "force along +z that activates the task and is required during the hold");
  f.object("gauge", task.gauge,
           "filtered display of the spring force to the subject; null: the unfiltered rendered force is displayed");
  f.object("threshold", task.threshold,
           "force that the task compares with min_press_N, if it differs from the displayed force; null: the displayed "
           "force");
  f.number("hold_s", task.hold, {0.0, 1000.0, "s", true},
           "uninterrupted time on the target after which the target is removed");
  f.number("time_limit_s", task.time_limit, {0.0, 1000.0, "s", true},
           "time from activation after which the target disappears");
}

static void describe(Fields& f, Subject& subject) {
  f.number("reaction_delay_s", subject.reaction_delay, {0.0, 10.0, "s"},
           "reaction time, from the display to the hand (our assumption)");
  f.number("bandwidth_Hz", subject.bandwidth, {0.0, 100.0, "Hz"},
           "bandwidth with which the subject follows the target on the display (our assumption)");
  f.number("stiffness_N_per_m", subject.stiffness, {1.0, 1e6, "N/m"},
           "stiffness of the hand about its intended position (our assumption)");
  f.number("damping_N_s_per_m", subject.damping, {0.0, 1e6, "N s/m"}, "damping of the hand (our assumption)");
  f.number("press_N", subject.press, {0.0, 1000.0, "N"},
           "force on the gauge that the subject aims at (our assumption)");
  f.number("press_bandwidth_Hz", subject.press_bandwidth, {0.0, 100.0, "Hz"},
           "bandwidth with which the subject corrects the force (our assumption)");
  f.number("motor_noise_N", subject.motor_noise, {0.0, 1000.0, "N"},
           "standard deviation of the noise of each force component (our assumption)");
  f.number("tilt_noise_rad", subject.tilt_noise, {0.0, 1.0, "rad"},
           "standard deviation of the noise of the tilt, for a wrist that turns the tool (our assumption)");
  f.number("noise_bandwidth_Hz", subject.noise_bandwidth, {0.0, 1e4, "Hz"},
           "cutoff frequency of the first-order low-pass of both noises (our assumption)");
  f.number("height_per_tilt_m_per_rad", subject.height_per_tilt, {1e-6, 1.0, "m/rad"},
           "rise of the tip per change of tilt that the subject expects (our assumption)");
  f.number("max_speed_m_per_s", subject.max_speed, {0.0, 100.0, "m/s"},
           "largest speed of the intended position (our assumption)");
  f.number("max_turn_rad_per_s", subject.max_turn, {0.0, 100.0, "rad/s"},
           "largest speed of the wrist (our assumption)");
  f.number("max_force_N", subject.max_force, {0.0, 1000.0, "N"},
           "largest force of the arm; at this force the arm yields (our assumption)");
}

static void describe(Fields& f, TrackingHandFields& hand) {
  f.object("task", hand.task, "targets and rules of a trial", Presence::required);
  f.objects("subjects", hand.subjects, {1, 1000},
            "simulated subjects; each object holds the parameters of one subject");
  f.integer("trials", hand.trials, {1, 1000},
            "number of trials of each subject; each starts from the initial state with its own seed");
}

void describe(Fields& f, HandFields& hand) {
  f.variant(hand, "hand",
            {{"none", "no hand: only the rendered force moves the tool"},
             {"force", "force as a function of time"},
             {"push", "force as a function of time, in a constant direction that may be tilted from straight down"},
             {"impedance", "spring and damper that pull the handle to a moving target"},
             {"drag", "hand that leads the tool along a path over the surface and presses along its normal"},
             {"tracking", "simulated subject that follows targets on a display"},
             {"mass_spring_damper", "passive mass, spring and damper, fixed to the handle of an impedance device"}});
}

namespace {

std::unique_ptr<TrackingHand> make_tracking_hand(const Scenario& scenario, const TrackingHandFields& fields,
                                                 Trial trial) {
  // The order of targets depends only on the scenario's seed and on the trial. A subject therefore gets the same order
  // with every algorithm.
  return std::make_unique<TrackingHand>(fields.subjects[trial.subject],
                                        TargetTask(fields.task, derived_seed(scenario, trial, RandomUse::target_order)),
                                        scenario.motion.orientation->tilt(0.0), scenario.time.step,
                                        derived_seed(scenario, trial, RandomUse::motor_noise));
}

/// Sets parts.hand and, if the hand controls the tilt, parts.motion. Precondition: parts.shell is set.
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
  // If the hand does not control the orientation, use the scripted or recorded motion.
  if (!parts.motion) parts.motion = make_motion(scenario, files);
}

}  // namespace hapbench
