#include "scenarios/scene/profiles.hpp"

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {
namespace {

constexpr double kMaxMagnitude = 1e9;  ///< largest magnitude of a value or a time of a profile

/// All shapes of profiles except a constant. A constant is written as a number.
using TimeVaryingShape = std::variant<Profile::Ramp, Profile::Sine, Profile::Waypoints>;

/// Throws InputError unless the times of the waypoints increase strictly.
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
  f.number("rate_per_s", ramp.rate_per_s, range, "slope, in units of the value per second", Presence::required);
}

void describe_shape(Fields& f, Profile::Sine& sine, NumberRange range) {
  f.number("mean", sine.mean, range, "mean value m of m + a sin(2 pi t / T + phase)", Presence::required);
  f.number("amplitude", sine.amplitude, range, "amplitude a", Presence::required);
  f.number("period_s", sine.period_s, {0.0, kMaxMagnitude, "s", true}, "period T", Presence::required);
  f.number("phase_rad", sine.phase_rad, {-kMaxMagnitude, kMaxMagnitude, "rad"}, "phase at t = 0");
}

void describe_shape(Fields& f, Profile::Waypoints& waypoints, NumberRange range) {
  const auto point = [range](Fields& p, std::pair<double, double>& value) {
    p.pair("a pair [time in s, value]", value.first, {-kMaxMagnitude, kMaxMagnitude, "s"}, value.second, range);
  };
  f.list("points", waypoints.points, {1, 1'000'000},
         "pairs [time in s, value] with increasing times; before the first and after the last, the value is constant",
         point, Presence::required);
  f.choice("interpolation", waypoints.interpolation, {"linear", "cosine"}, "interpolation",
           "between the points: linear, or cosine (zero slope at each point)");
  if (f.reads()) check_times(waypoints, f.at());
}

}  // namespace

void profile(Fields& f, std::string_view name, Profile& profile, const char* unit, const char* doc, Presence presence) {
  const NumberRange range = {-kMaxMagnitude, kMaxMagnitude, unit};
  const auto describe_profile = [&](Fields& value) {
    // Store the profile as a number if it is constant, otherwise as a time-varying shape.
    double constant = profile.is_constant() ? profile(0.0) : 0.0;
    TimeVaryingShape moving;
    const auto take = [&moving](const auto& shape) {
      if constexpr (!std::is_same_v<std::decay_t<decltype(shape)>, Profile::Constant>) moving = shape;
    };
    std::visit(take, profile.shape());
    // Describe the profile as a number, or as an object with a type. If the fields are read from a file, set `profile`.
    value.plain_or_object(
        !profile.is_constant(),
        [&](Fields& v) {
          v.number(constant, range);
          if (v.reads()) profile = Profile(constant);
        },
        [&](Fields& v) {
          v.variant(moving, "profile",
                    {{"ramp", "value that grows at a constant rate"},
                     {"sine", "sinusoidal oscillation about a mean value"},
                     {"waypoints", "values at given times, with linear or cosine interpolation"}},
                    Untyped::refused, [range](Fields& s, auto& shape) { describe_shape(s, shape, range); });
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

}  // namespace hapbench
