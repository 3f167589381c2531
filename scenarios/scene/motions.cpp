#include "scenarios/scene/motions.hpp"

#include <array>
#include <optional>
#include <utility>
#include <variant>

#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/profiles.hpp"

namespace hapbench {

static void describe(Fields& f, OrientationFields& orientation) {
  constexpr NumberRange kDirection = {-1e9, 1e9, "1"};
  f.vector3("up", orientation.up, kDirection,
            "direction opposite to gravity; default [0,1,0] in planar scenes, else [0,0,1]", Presence::no_default);
  f.vector3("lean", orientation.lean, kDirection,
            "direction in which the tool leans at azimuth 0; perpendicular to up");
  profile(f, "tilt_rad", orientation.tilt, "rad",
          "tilt alpha as a function of time: the tool's axis is -(cos alpha up + sin alpha lean')");
  profile(f, "azimuth_rad", orientation.azimuth, "rad",
          "azimuth as a function of time: lean' is the direction lean, rotated by this angle about up (right-handed)");
  profile(
      f, "roll_rad", orientation.roll, "rad",
      "roll as a function of time: rotation about the tool's own axis (right-handed); if tilt, azimuth and roll are "
      "0, the tool's x axis points along lean and its z axis along up");
}

static void describe(Fields& f, PrescribedPosition& position) {
  profiles(f, {"x_m", "y_m", "z_m"}, position.coordinates, "m", "coordinate of the tip centre, as a function of time",
           Presence::required);
  f.if_any("shift_m", position.shift, "shifts the whole path [m]; compare --jitter sets it",
           [](Fields& value, Vec3& shift) {
             value.vector3(shift, {-1e3, 1e3, "m"});
           });
}

/// Returns the profile with `shift` added to its values.
static Profile shifted(const Profile& profile, double shift) {
  Profile::Shape shape = profile.shape();
  if (auto* constant = std::get_if<Profile::Constant>(&shape)) constant->value += shift;
  if (auto* ramp = std::get_if<Profile::Ramp>(&shape)) ramp->start += shift;
  if (auto* sine = std::get_if<Profile::Sine>(&shape)) sine->mean += shift;
  if (auto* waypoints = std::get_if<Profile::Waypoints>(&shape))
    for (auto& point : waypoints->points) point.second += shift;
  return shape;
}

static void describe(Fields& f, RecordedPosition& position) {
  f.file(
      position.file, {FileContent::Kind::stroke},
      "stroke as CSV with the header time_s,px_m,py_m,pz_m, then axis_x,axis_y,axis_z or qw,qx,qy,qz, then optionally "
      "a measured force mfx_N,mfy_N,mfz_N; \"hapbench import stroke\" writes such a file; path relative to the "
      "scenario file");
}

static void describe(Fields& f, PositionFields& position) {
  f.variant(position, "position",
            {{"free", "the forces move the tool"},
             {"prescribed", "the tip centre follows given functions of time"},
             {"file", "the tool follows a recorded stroke"}});
}

void describe(Fields& f, MotionFields& motion) {
  f.object_if_any("orientation", motion.orientation,
                  "scripted orientation of the tool; not allowed with a recorded motion");
  f.value(
      "position", motion.position,
      "free: the integrator computes the position; prescribed or file: the position is given, and forces are computed "
      "but do not move the tool");
  if (!f.reads() || !std::holds_alternative<RecordedPosition>(motion.position)) return;
  // Reject an orientation field, because a recorded motion includes the orientation.
  if (f.given("orientation")) {
    fail_at(f.at() + "/orientation",
            "contradicts position type \"file\", whose columns give the orientation; allowed: one of the two");
  }
  motion.orientation.reset();
}

Orientation make_orientation(const OrientationFields& fields) {
  return {fields.up.normalized(), fields.lean.normalized(), fields.tilt, fields.azimuth, fields.roll};
}

std::unique_ptr<Motion> make_motion(const Scenario& scenario, const NamedFiles& files) {
  if (std::holds_alternative<RecordedPosition>(scenario.motion.position))
    return std::make_unique<RecordedMotion>(files.at(kMotionFile).stroke()->motion);
  std::optional<std::array<Profile, 3>> position;
  if (const auto* prescribed = std::get_if<PrescribedPosition>(&scenario.motion.position))
    position = prescribed->coordinates;
  if (const auto* prescribed = std::get_if<PrescribedPosition>(&scenario.motion.position);
      prescribed != nullptr && prescribed->shift)
    for (std::size_t k = 0; k < 3; ++k)
      (*position)[k] = shifted((*position)[k], (*prescribed->shift)[static_cast<Eigen::Index>(k)]);
  return std::make_unique<ScriptedMotion>(make_orientation(*scenario.motion.orientation), std::move(position));
}

}  // namespace hapbench
