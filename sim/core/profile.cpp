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

/// Value and time derivative.
std::pair<double, double> on_leg(const Profile::Waypoints& w, double t) {
  const auto& p = w.points;
  if (p.empty()) return {0.0, 0.0};
  if (!(t >= p.front().first)) return {p.front().second, 0.0};
  if (t >= p.back().first) return {p.back().second, 0.0};
  const auto next = std::upper_bound(p.begin(), p.end(), t, [](double time, const auto& q) { return time < q.first; });
  const auto last = next - 1;
  const double duration = next->first - last->first, rise = next->second - last->second;
  const double s = (t - last->first) / duration;
  if (w.interpolation == Profile::Interpolation::linear) return {last->second + s * rise, rise / duration};
  const auto [sine, cosine] = math::sine_cosine(std::numbers::pi * s);
  return {last->second + (0.5 - 0.5 * cosine) * rise, 0.5 * std::numbers::pi * sine * rise / duration};
}

double evaluate(const Profile::Waypoints& w, double t) {
  return on_leg(w, t).first;
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
  return on_leg(w, t).second;
}

}  // namespace

double Profile::operator()(double t) const noexcept {
  return std::visit([t](const auto& shape) { return evaluate(shape, t); }, shape_);
}

double Profile::rate(double t) const noexcept {
  return std::visit([t](const auto& shape) { return rate_of(shape, t); }, shape_);
}

}  // namespace hapbench
