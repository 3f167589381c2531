#include "scenarios/format/input_error.hpp"
#include "scenarios/format/json_file.hpp"
#include "scenarios/format/parts.hpp"

namespace hapbench {
namespace {

constexpr double kLargestValue = 1e9;

using MovingShape = std::variant<Profile::Ramp, Profile::Sine, Profile::Waypoints>;

void check_times(const Profile::Waypoints& waypoints, const std::string& at) {
  const auto& points = waypoints.points;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i - 1].first < points[i].first) continue;
    fail_at(element(at + "/points", i), "got time " + shown(points[i].first) + " after " + shown(points[i - 1].first) +
                                            "; allowed: strictly increasing times");
  }
}

void describe_shape(Fields& f, Profile::Ramp& ramp, NumberRange range) {
  f.number("start", ramp.start, range, "value at t = 0", Presence::required);
  f.number("rate_per_s", ramp.rate_per_s, range, "slope, per second", Presence::required);
}

void describe_shape(Fields& f, Profile::Sine& sine, NumberRange range) {
  f.number("mean", sine.mean, range, "m of m + a sin(2 pi t / T + phase)", Presence::required);
  f.number("amplitude", sine.amplitude, range, "a", Presence::required);
  f.number("period_s", sine.period_s, {0.0, kLargestValue, "s", true}, "T", Presence::required);
  f.number("phase_rad", sine.phase_rad, {-kLargestValue, kLargestValue, "rad"}, "phase at t = 0");
}

void describe_shape(Fields& f, Profile::Waypoints& waypoints, NumberRange range) {
  const auto point = [range](Fields& p, std::pair<double, double>& value) {
    p.pair("a pair [time in s, value]", value.first, {-kLargestValue, kLargestValue, "s"}, value.second, range);
  };
  f.list("points", waypoints.points, {1, 1'000'000}, "[t, v] pairs, t increasing; held constant outside", point,
         Presence::required);
  f.choice("interpolation", waypoints.interpolation, {"linear", "cosine"}, "interpolation",
           "between the points: straight, or cosine (at rest in each point)");
  if (f.reads()) check_times(waypoints, f.at());
}

}  // namespace

void profile(Fields& f, std::string_view name, Profile& profile, const char* unit, const char* doc, Presence presence) {
  const NumberRange range = {-kLargestValue, kLargestValue, unit};
  const auto describe_profile = [&](Fields& value) {
    double constant = profile.is_constant() ? profile(0.0) : 0.0;
    MovingShape moving;
    const auto take = [&moving](const auto& shape) {
      if constexpr (!std::is_same_v<std::decay_t<decltype(shape)>, Profile::Constant>) moving = shape;
    };
    std::visit(take, profile.shape());
    value.plain_or_object(
        !profile.is_constant(),
        [&](Fields& v) {
          v.number(constant, range);
          if (v.reads()) profile = Profile(constant);
        },
        [&](Fields& v) {
          v.variant(moving, "profile",
                    {{"ramp", "a value that grows at a constant rate"},
                     {"sine", "an oscillation about a value"},
                     {"waypoints", "values at times, joined by straight lines or cosines"}},
                    [range](Fields& s, auto& shape) { describe_shape(s, shape, range); });
          if (!v.reads()) return;
          std::visit([&](auto& shape) { profile = Profile(Profile::Shape(std::move(shape))); }, moving);
        });
  };
  f.field(name, doc, presence, [&](Fields& value) { value.shared("profile", describe_profile); });
}

void profiles(Fields& f, const char* const (&names)[3], std::array<Profile, 3>& profiles, const char* unit,
              const char* doc, Presence presence) {
  for (std::size_t i = 0; i < 3; ++i) profile(f, names[i], profiles[i], unit, doc, presence);
}

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
  profiles(f, {"x_m", "y_m", "z_m"}, position.coordinates, "m", "tip centre over time", Presence::required);
}

static void describe(Fields& f, RecordedPosition& position) {
  f.file(
      position.file, {FileContent::Kind::stroke},
      "CSV with header time_s,px_m,py_m,pz_m, then axis_x,axis_y,axis_z or qw,qx,qy,qz, then perhaps a measured force "
      "mfx_N,mfy_N,mfz_N (\"hapbench import stroke\" makes one); relative to the scenario file");
}

void describe(Fields& f, PositionFields& position) {
  f.variant(position, "position",
            {{"free", "forces move the tool"},
             {"prescribed", "the tip centre follows functions of time"},
             {"file", "plays a recorded stroke back"}});
}

void describe(Fields& f, MotionFields& motion) {
  f.object_if_any("orientation", motion.orientation, "scripted orientation; not with a recorded motion");
  f.value("position", motion.position, "free: integrated; prescribed or file: forces are computed, not integrated");
  if (!f.reads() || !std::holds_alternative<RecordedPosition>(motion.position)) return;
  if (f.given("orientation")) {
    fail_at(f.at() + "/orientation",
            "contradicts position type \"file\", whose columns give the orientation; allowed: one of the two");
  }
  motion.orientation.reset();
}

bool position_is_free(const MotionFields& motion) {
  return std::holds_alternative<FreePosition>(motion.position);
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
