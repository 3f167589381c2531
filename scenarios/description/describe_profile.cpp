#include "scenarios/description/descriptions.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

constexpr double kLargestValue = 1e9;

constexpr Choice<Profile::Interpolation> kInterpolations[] = {{"linear", Profile::Interpolation::linear},
                                                              {"cosine", Profile::Interpolation::cosine}};

using MovingShape = std::variant<Profile::Ramp, Profile::Sine, Profile::Waypoints>;

void check_times(const Profile::Waypoints& waypoints, const std::string& at) {
  const auto& points = waypoints.points;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i - 1].first < points[i].first) continue;
    throw InputError(InputError::Kind::relation, element(at + "/points", i),
                     "got time " + shown(points[i].first) + " after " + shown(points[i - 1].first) +
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
    p.pair(
        "a pair [time in s, value]",
        [&](Fields& t) {
          t.number(value.first, {-kLargestValue, kLargestValue, "s"});
        },
        [&](Fields& v) { v.number(value.second, range); });
  };
  f.list("points", waypoints.points, {1, 1'000'000}, "[t, v] pairs, t increasing; held constant outside", point,
         Presence::required);
  f.choice("interpolation", waypoints.interpolation, kInterpolations, "interpolation",
           "between the points: straight, or cosine (at rest in each point)");
  if (f.reads()) check_times(waypoints, f.at());
}

/// The parts of a profile that a number and an object describe.
struct Parts {
  double constant = 0.0;
  MovingShape moving;
  bool is_constant = true;
};

Parts parts_of(const Profile& profile) {
  Parts parts;
  std::visit(
      [&parts](const auto& shape) {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Profile::Constant>) {
          parts.constant = shape.value;
        } else {
          parts.moving = shape;
          parts.is_constant = false;
        }
      },
      profile.shape());
  return parts;
}

}  // namespace

void profile(Fields& f, std::string_view name, Profile& profile, const char* unit, const char* doc, Presence presence) {
  const NumberRange range = {-kLargestValue, kLargestValue, unit};
  f.field(name, doc, presence, [&](Fields& value) {
    Parts parts = parts_of(profile);
    value.number_or_object(
        !parts.is_constant,
        [&](Fields& v) {
          v.number(parts.constant, range);
          if (v.reads()) profile = Profile(parts.constant);
        },
        [&](Fields& v) {
          v.variant(parts.moving, "profile", {"ramp", "sine", "waypoints"},
                    [range](Fields& s, auto& shape) { describe_shape(s, shape, range); });
          if (!v.reads()) return;
          std::visit([&](auto& shape) { profile = Profile(Profile::Shape(std::move(shape))); }, parts.moving);
        });
  });
}

}  // namespace hapbench
