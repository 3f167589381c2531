#include "scenarios/studies/worst_motion/search_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

constexpr double kMostSearchSteps = 1e5;  // of one run, or a search would take days

bool is_hole(const Scenario& scenario) {
  return std::holds_alternative<Hole2d>(scenario.environment) ||
         std::holds_alternative<BlockEnvironment>(scenario.environment);
}

Vec3 nearest_point(const PointShell& shell, const Vec3& to) {
  Vec3 nearest = shell.point(0).position;
  for (std::size_t i = 1; i < shell.size(); ++i) {
    const Vec3 point = shell.point(i).position;
    if ((point - to).squaredNorm() < (nearest - to).squaredNorm()) nearest = point;
  }
  return nearest;
}

/// The place on the way from `from` to `to` where the tool just touches: `from` itself if it does so there, `to` if it
/// never does.
Vec3 first_touch(const Vec3& from, const Vec3& to, double stride, const std::function<bool(const Vec3&)>& touches) {
  if (touches(from)) return from;
  const auto place = [&](double part) { return Vec3(from + part * (to - from)); };
  const double strides = std::clamp(std::ceil((to - from).norm() / stride), 1.0, kMostSearchSteps);
  double apart = 0.0, touching = 1.0;
  for (double i = 1.0; i < strides; ++i) {
    if (touches(place(i / strides))) {
      touching = i / strides;
      break;
    }
    apart = i / strides;
  }
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (apart + touching);
    (touches(place(middle)) ? touching : apart) = middle;
  }
  return place(touching);
}

/// Where the scene's tool, moved without turning, first touches the shell.
Vec3 place_at_surface(const Scenario& scenario, const std::shared_ptr<const PointShell>& shell) {
  const SimulationParts parts = assemble(scenario, shell, {});
  ContactBuffer contacts(parts.source->capacity());
  const Vec3 axis = parts.motion->axis_at(0.0);
  const auto touches = [&](const Vec3& position) {
    parts.source->contacts_at({position, axis}, contacts);
    return !contacts.empty();
  };
  const Vec3& start = scenario.initial.position;
  return first_touch(start, nearest_point(*shell, start), 0.25 * parts.tool->half_width(), touches);
}

Profile profile_of(const Trajectory& trajectory, const std::function<double(const Waypoint&)>& value) {
  Profile::Waypoints waypoints{{}, Profile::Interpolation::cosine};
  for (const Waypoint& w : trajectory) waypoints.points.emplace_back(w.time, value(w));
  const double first = value(trajectory.front());
  const bool constant =
      std::all_of(trajectory.begin(), trajectory.end(), [&](const Waypoint& w) { return value(w) == first; });
  return constant ? Profile(first) : Profile(Profile::Shape(std::move(waypoints)));
}

/// A hand whose spring pulls with the trajectory's forces where the tool starts, and aims within reach.
ImpedanceHandFields reaching_hand(const Vec3& start, const Box& reach, const Trajectory& trajectory) {
  ImpedanceHandFields hand;
  for (int i = 0; i < 3; ++i) {
    const auto target = [&, i](const Waypoint& w) {
      const double aim = std::clamp(start[i] + w.force[i] / hand.stiffness, reach.min[i], reach.max[i]);
      return std::round(1e6 * aim) / 1e6;  // short to write
    };
    hand.target[static_cast<std::size_t>(i)] = profile_of(trajectory, target);
  }
  return hand;
}

ForceHandFields pushing_hand(const Trajectory& trajectory) {
  ForceHandFields hand;
  for (int i = 0; i < 3; ++i) {
    hand.force[static_cast<std::size_t>(i)] = profile_of(trajectory, [i](const Waypoint& w) { return w.force[i]; });
  }
  return hand;
}

}  // namespace

void check_search_scene(const Scenario& scenario) {
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) {
    throw InputError(InputError::Kind::relation, "/environment/type",
                     "got \"springs\", which have no surface; allowed for --search: environments with a shell");
  }
  const double least = TrajectoryBounds{}.duration / kMostSearchSteps;
  if (scenario.time.step < least) {
    throw InputError(InputError::Kind::relation, "/time/step_s",
                     fmt::format("got {}; allowed for --search: at least {}", scenario.time.step, least));
  }
  if (!std::holds_alternative<FreePosition>(scenario.motion.position)) {
    throw InputError(InputError::Kind::relation, "/motion/position/type", "allowed for --search: \"free\"");
  }
}

SearchScene search_scene(const Scenario& scenario) {
  check_search_scene(scenario);
  SearchScene scene{scenario, make_shell(scenario), false, {}};
  if (scene.shell->size() == 0) {
    throw InputError(InputError::Kind::relation, "/environment", "has no points; allowed for --search: a surface");
  }
  Box bounds = scene.shell->bounds();
  scene.planar = bounds.min.z() == bounds.max.z() && scenario.motion.orientation->up.z() == 0.0;
  if (is_hole(scenario)) return scene;
  scene.scenario.initial.position = place_at_surface(scenario, scene.shell);
  scene.scenario.initial.velocity = Vec3::Zero();
  const double width = 2.0 * make_tool(scenario)->half_width();
  bounds.min.array() -= width;
  bounds.max.array() += width;
  scene.reach = bounds;
  return scene;
}

Scenario with_trajectory(const SearchScene& scene, const Trajectory& trajectory) {
  Scenario scenario = scene.scenario;
  scenario.time.steps =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(trajectory.back().time / scenario.time.step)));
  scenario.motion.orientation->tilt = profile_of(trajectory, [](const Waypoint& w) { return w.tilt; });
  scenario.motion.orientation->azimuth = profile_of(trajectory, [](const Waypoint& w) { return w.azimuth; });
  if (scene.reach) {
    scenario.hand = reaching_hand(scenario.initial.position, *scene.reach, trajectory);
  } else {
    scenario.hand = pushing_hand(trajectory);
  }
  scenario.device = IdealDeviceFields{};
  scenario.record = {};
  scenario.record.trajectory = false;
  scenario.record.energy = true;
  scenario.expect = {};
  return scenario;
}

}  // namespace hapbench
