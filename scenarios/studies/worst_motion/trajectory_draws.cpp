#include "scenarios/studies/worst_motion/trajectory_draws.hpp"

#include <algorithm>
#include <cmath>

namespace hapbench {
namespace {

/// Shorter ends cut off a motion, as shares of its duration.
constexpr double kCuts[] = {0.5, 0.8, 0.95};
/// Numbers of one waypoint: tilt, azimuth, three components of the force.
constexpr std::size_t kNumbers = 5;

double& number(Waypoint& w, std::size_t i) {
  if (i == 0) return w.tilt;
  return i == 1 ? w.azimuth : w.force[static_cast<Eigen::Index>(i - 2)];
}

/// The nearest multiple of 1 / n, as the number that prints shortly.
double rounded(double value, double n) {
  return std::round(value * n) / n;
}

/// `value` no further from `last` than `most`.
double near(double value, double last, double most) {
  return std::clamp(value, last - most, last + most);
}

}  // namespace

Trajectory TrajectoryDraws::within_bounds(Trajectory trajectory) const {
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    Waypoint& w = trajectory[i];
    w.time = rounded(w.time, 1e3);
    if (planar_) {
      w.azimuth = azimuth_;
      w.force.z() = 0.0;
    }
    if (i == 0) {
      w.tilt = tilt_;
      w.azimuth = azimuth_;
    } else {
      const Waypoint& last = trajectory[i - 1];
      const double most = bounds_.rate * (w.time - last.time);
      // Towards zero, so that rounding leaves the bounds alone.
      w.tilt = rounded(near(std::clamp(w.tilt, -bounds_.tilt, bounds_.tilt), last.tilt, most), 1e4);
      w.azimuth = rounded(near(w.azimuth, last.azimuth, most), 1e4);
    }
    const double length = w.force.norm();
    if (length > bounds_.force) w.force *= bounds_.force / length;
    for (double& component : w.force) component = std::trunc(component * 1e3) / 1e3;
  }
  return trajectory;
}

Trajectory TrajectoryDraws::at_rest() const {
  return {{0.0, tilt_, azimuth_, Vec3::Zero()}, {bounds_.duration, tilt_, azimuth_, Vec3::Zero()}};
}

Trajectory TrajectoryDraws::random(Random& random) const {
  Trajectory trajectory(std::max<std::size_t>(2, bounds_.waypoints));
  const double leg = bounds_.duration / static_cast<double>(trajectory.size() - 1);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    Waypoint& w = trajectory[i];
    w.time = static_cast<double>(i) * leg;
    w.tilt = random.uniform(-bounds_.tilt, bounds_.tilt);
    w.azimuth = random.uniform(-1.0, 1.0) * bounds_.rate * bounds_.duration;
    w.force = bounds_.force * random.uniform() * (planar_ ? random.direction_in_plane() : random.direction());
  }
  return within_bounds(std::move(trajectory));
}

Trajectory TrajectoryDraws::changed(Trajectory from, double step, Random& random) const {
  const double ranges[kNumbers] = {bounds_.tilt, bounds_.rate * bounds_.duration, bounds_.force, bounds_.force,
                                   bounds_.force};
  for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
    const std::size_t i = random.below(kNumbers);
    number(from[random.below(from.size())], i) += step * ranges[i] * random.normal();
  }
  return within_bounds(std::move(from));
}

std::size_t TrajectoryDraws::simplifications(const Trajectory& trajectory) const {
  return std::size(kCuts) + trajectory.size() + kNumbers * trajectory.size();
}

std::optional<Trajectory> TrajectoryDraws::simplified(const Trajectory& trajectory, std::size_t i) const {
  Trajectory simpler = trajectory;
  if (i < std::size(kCuts)) {
    const double end = rounded(kCuts[i] * trajectory.back().time, 1e3);
    std::erase_if(simpler, [&](const Waypoint& w) { return w.time >= end && w.time > 0.0; });
    if (end <= 0.0 || end >= trajectory.back().time || simpler.size() == trajectory.size()) return std::nullopt;
    // The waypoint that the motion was approaching moves to the new end.
    simpler.push_back(trajectory[simpler.size()]);
    simpler.back().time = end;
  } else if (i - std::size(kCuts) < trajectory.size()) {
    const std::size_t dropped = i - std::size(kCuts);
    if (dropped == 0 || trajectory.size() <= 2) return std::nullopt;
    simpler.erase(simpler.begin() + static_cast<std::ptrdiff_t>(dropped));
  } else {
    const std::size_t place = i - std::size(kCuts) - trajectory.size();
    number(simpler[place / kNumbers], place % kNumbers) = 0.0;
  }
  simpler = within_bounds(std::move(simpler));
  const auto same = [](const Waypoint& a, const Waypoint& b) {
    return a.time == b.time && a.tilt == b.tilt && a.azimuth == b.azimuth && a.force == b.force;
  };
  if (std::equal(simpler.begin(), simpler.end(), trajectory.begin(), trajectory.end(), same)) return std::nullopt;
  return simpler;
}

}  // namespace hapbench
