#include "sim/core/profile.hpp"

#include <algorithm>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

double evaluate(const Profile::Constant& c, double) {
  return c.value;
}

double evaluate(const Profile::Ramp& r, double t) {
  return r.start + r.rate_per_s * t;
}

double evaluate(const Profile::Sine& s, double t) {
  return s.mean + s.amplitude * math::sin(2.0 * std::numbers::pi * t / s.period_s + s.phase_rad);
}

/// The straight or curved way from one waypoint to the next.
struct Leg {
  double start, rise, duration;
  double share;  ///< of the duration that has passed
};

/// Before the first and after the last waypoint nothing rises.
Leg leg_at(const Profile::Waypoints& w, double t) {
  const auto& p = w.points;
  if (p.empty()) return {0.0, 0.0, 1.0, 0.0};
  if (!(t >= p.front().first)) return {p.front().second, 0.0, 1.0, 0.0};
  if (t >= p.back().first) return {p.back().second, 0.0, 1.0, 0.0};
  const auto next = std::upper_bound(p.begin(), p.end(), t, [](double time, const auto& q) { return time < q.first; });
  const auto last = next - 1;
  const double duration = next->first - last->first;
  return {last->second, next->second - last->second, duration, (t - last->first) / duration};
}

double evaluate(const Profile::Waypoints& w, double t) {
  const Leg leg = leg_at(w, t);
  if (leg.rise == 0.0) return leg.start;
  if (w.interpolation == Profile::Interpolation::linear) return leg.start + leg.share * leg.rise;
  return leg.start + (0.5 - 0.5 * math::cos(std::numbers::pi * leg.share)) * leg.rise;
}

double rate_of(const Profile::Constant&, double) {
  return 0.0;
}

double rate_of(const Profile::Ramp& r, double) {
  return r.rate_per_s;
}

double rate_of(const Profile::Sine& s, double t) {
  const double omega = 2.0 * std::numbers::pi / s.period_s;
  return s.amplitude * omega * math::cos(omega * t + s.phase_rad);
}

double rate_of(const Profile::Waypoints& w, double t) {
  const Leg leg = leg_at(w, t);
  if (leg.rise == 0.0) return 0.0;
  if (w.interpolation == Profile::Interpolation::linear) return leg.rise / leg.duration;
  return 0.5 * std::numbers::pi * math::sin(std::numbers::pi * leg.share) * leg.rise / leg.duration;
}

}  // namespace

double Profile::operator()(double t) const noexcept {
  return std::visit([t](const auto& shape) { return evaluate(shape, t); }, shape_);
}

double Profile::rate(double t) const noexcept {
  return std::visit([t](const auto& shape) { return rate_of(shape, t); }, shape_);
}

}  // namespace hapbench
