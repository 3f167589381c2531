#include "scenarios/description/motion_codec.hpp"

#include "scenarios/description/object.hpp"
#include "scenarios/description/profile_codec.hpp"
#include "scenarios/description/values.hpp"

namespace hapbench {
namespace {

constexpr NumberRange kDirection = {-1e9, 1e9, "1"};

std::shared_ptr<ObjectCodec<OrientationFields>> orientation_codec() {
  auto orientation = object<OrientationFields>();
  orientation->deferred(
      "up", [](auto& o) -> auto& { return o.up; }, vector3(kDirection),
      "against gravity; default [0,1,0] in planar scenes, else [0,0,1]", Vec3(Vec3::Zero()));
  orientation->optional(
      "lean", [](auto& o) -> Vec3& { return o.lean; }, vector3(kDirection),
      "where the tool leans at azimuth 0; perpendicular to up");
  orientation->optional(
      "tilt_rad", [](auto& o) -> Profile& { return o.tilt; }, profile("rad"),
      "alpha: axis = -(cos alpha up + sin alpha lean')");
  orientation->optional(
      "azimuth_rad", [](auto& o) -> Profile& { return o.azimuth; }, profile("rad"),
      "lean' is lean turned by this about up, right-handed");
  return orientation;
}

CodecPtr<PositionFields> position_codec() {
  auto prescribed = object<PrescribedPosition>();
  prescribed->required(
      "x_m", [](auto& p) -> Profile& { return p.coordinates[0]; }, profile("m"), "tip centre over time");
  prescribed->required(
      "y_m", [](auto& p) -> Profile& { return p.coordinates[1]; }, profile("m"), "tip centre over time");
  prescribed->required(
      "z_m", [](auto& p) -> Profile& { return p.coordinates[2]; }, profile("m"), "tip centre over time");
  auto recorded = object<RecordedPosition>();
  recorded->required(
      "file", [](auto& p) -> std::string& { return p.file; }, text(4096),
      "CSV with header time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z; relative to the scenario file");
  auto position = tagged<PositionFields>("position");
  position->alternative("free", object<FreePosition>())
      .alternative("prescribed", prescribed)
      .alternative("file", recorded);
  return position;
}

void check_one_source_of_orientation(const MotionFields& motion, const std::string& at) {
  if (!motion.orientation || !std::holds_alternative<RecordedPosition>(motion.position)) return;
  throw InputError(
      InputError::Kind::relation, member(at, "orientation"),
      "contradicts position type \"file\", whose axis columns give the orientation; allowed: one of the two");
}

}  // namespace

CodecPtr<MotionFields> motion_codec() {
  auto motion = object<MotionFields>();
  motion->deferred(
      "orientation", [](auto& m) -> auto& { return m.orientation; }, CodecPtr<OrientationFields>(orientation_codec()),
      "scripted orientation; not with a recorded motion");
  motion->optional(
      "position", [](auto& m) -> PositionFields& { return m.position; }, position_codec(),
      "free: integrated; prescribed or file: forces are computed, not integrated");
  motion->relation(check_one_source_of_orientation);
  return motion;
}

}  // namespace hapbench
