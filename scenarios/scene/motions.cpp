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
  f.vector3("up", orientation.up, kDirection, "against gravity; default [0,1,0] in planar scenes, else [0,0,1]",
            Presence::no_default);
  f.vector3("lean", orientation.lean, kDirection, "where the tool leans at azimuth 0; perpendicular to up");
  profile(f, "tilt_rad", orientation.tilt, "rad", "alpha: axis = -(cos alpha up + sin alpha lean')");
  profile(f, "azimuth_rad", orientation.azimuth, "rad", "lean' is lean turned by this about up, right-handed");
  profile(f, "roll_rad", orientation.roll, "rad",
          "turn about the tool's axis, right-handed; where all three angles are 0 its x points along lean, its z along "
          "up");
}

static void describe(Fields& f, PrescribedPosition& position) {
  profiles(f, {"x_m", "y_m", "z_m"}, position.coordinates, "m", "tip centre over time", Presence::required);
}

static void describe(Fields& f, RecordedPosition& position) {
  f.file(
      position.file, {FileContent::Kind::stroke},
      "CSV with header time_s,px_m,py_m,pz_m, then axis_x,axis_y,axis_z or qw,qx,qy,qz, then perhaps a measured force "
      "mfx_N,mfy_N,mfz_N (\"hapbench import stroke\" makes one); relative to the scenario file");
}

static void describe(Fields& f, PositionFields& position) {
  f.variant(position, "position",
            {{"free", "forces move the tool"},
             {"prescribed", "the tip centre follows functions of time"},
             {"file", "plays a recorded stroke back"}});
}

void describe(Fields& f, MotionFields& motion) {
  f.object_if_any("orientation", motion.orientation, "scripted orientation; not with a recorded motion");
  f.value("position", motion.position, "free: integrated; prescribed or file: forces are computed, not integrated");
  if (!f.reads() || !std::holds_alternative<RecordedPosition>(motion.position)) return;
  // A recorded motion includes the orientation.
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
  return std::make_unique<ScriptedMotion>(make_orientation(*scenario.motion.orientation), std::move(position));
}

}  // namespace hapbench
