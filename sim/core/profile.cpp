#include "sim/core/profile.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapbench {
namespace {

double evaluate(const Profile::Constant& c, double) {
  return c.value;
}

double evaluate(const Profile::Ramp& r, double t) {
  return r.start + r.rate_per_s * t;
}

double evaluate(const Profile::Sine& s, double t) {
  return s.mean + s.amplitude * std::sin(2.0 * std::numbers::pi * t / s.period_s + s.phase_rad);
}

double evaluate(const Profile::Waypoints& w, double t) {
  const auto& p = w.points;
  if (p.empty()) return 0.0;
  if (!(t > p.front().first)) return p.front().second;
  if (t >= p.back().first) return p.back().second;
  const auto next = std::upper_bound(p.begin(), p.end(), t, [](double time, const auto& q) { return time < q.first; });
  const auto last = next - 1;
  double s = (t - last->first) / (next->first - last->first);
  if (w.interpolation == Profile::Interpolation::cosine) s = 0.5 - 0.5 * std::cos(std::numbers::pi * s);
  return last->second + s * (next->second - last->second);
}

}  // namespace

double Profile::operator()(double t) const noexcept {
  return std::visit([t](const auto& shape) { return evaluate(shape, t); }, shape_);
}

}  // namespace hapbench
