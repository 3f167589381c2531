#include "scenarios/description/descriptions.hpp"
#include "scenarios/input/input_error.hpp"

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

static void describe(Fields&, FreePosition&) {}

static void describe(Fields& f, PrescribedPosition& position) {
  constexpr const char* kNames[] = {"x_m", "y_m", "z_m"};
  for (std::size_t i = 0; i < 3; ++i) {
    profile(f, kNames[i], position.coordinates[i], "m", "tip centre over time", Presence::required);
  }
}

static void describe(Fields& f, RecordedPosition& position) {
  f.file(
      position.file, {FileContent::Kind::stroke},
      "CSV with header time_s,px_m,py_m,pz_m, then axis_x,axis_y,axis_z or qw,qx,qy,qz, then perhaps a measured force "
      "mfx_N,mfy_N,mfz_N (\"hapbench import\" makes one); relative to the scenario file");
}

void describe(Fields& f, PositionFields& position) {
  f.variant(position, "position", {"free", "prescribed", "file"}, [](Fields& p, auto& fields) { describe(p, fields); });
}

void describe(Fields& f, MotionFields& motion) {
  f.if_any("orientation", motion.orientation, "scripted orientation; not with a recorded motion",
           [](Fields& o, OrientationFields& orientation) { o.object(orientation); });
  f.value("position", motion.position, "free: integrated; prescribed or file: forces are computed, not integrated");
  if (!f.reads() || !std::holds_alternative<RecordedPosition>(motion.position)) return;
  if (f.given("orientation")) {
    throw InputError(InputError::Kind::relation, f.at() + "/orientation",
                     "contradicts position type \"file\", whose columns give the orientation; allowed: one of the two");
  }
  motion.orientation.reset();
}

}  // namespace hapbench
