#include "sim/core/profile.hpp"

#include <algorithm>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

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

}  // namespace

double Profile::Sine::at(double t) const noexcept {
  return mean + amplitude * math::sin(2.0 * std::numbers::pi * t / period_s + phase_rad);
}

double Profile::Sine::rate(double t) const noexcept {
  const double omega = 2.0 * std::numbers::pi / period_s;
  return amplitude * omega * math::cos(omega * t + phase_rad);
}

double Profile::Waypoints::at(double t) const noexcept {
  const Leg leg = leg_at(*this, t);
  if (leg.rise == 0.0) return leg.start;
  if (interpolation == Interpolation::linear) return leg.start + leg.share * leg.rise;
  return leg.start + (0.5 - 0.5 * math::cos(std::numbers::pi * leg.share)) * leg.rise;
}

double Profile::Waypoints::rate(double t) const noexcept {
  const Leg leg = leg_at(*this, t);
  if (leg.rise == 0.0) return 0.0;
  if (interpolation == Interpolation::linear) return leg.rise / leg.duration;
  return 0.5 * std::numbers::pi * math::sin(std::numbers::pi * leg.share) * leg.rise / leg.duration;
}

double Profile::operator()(double t) const noexcept {
  return std::visit([t](const auto& shape) { return shape.at(t); }, shape_);
}

double Profile::rate(double t) const noexcept {
  return std::visit([t](const auto& shape) { return shape.rate(t); }, shape_);
}

}  // namespace hapbench
