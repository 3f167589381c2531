#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/geometry/point_shell.hpp"

/// Looks for the motion of the hand that an algorithm renders worst: a seeded random search; then an evolution
/// (1 + lambda), in which the best of several slightly changed copies replaces the motion if it is worse rendered; then
/// a simplification that removes what the motion does not need.
namespace hapbench {

/// What "worst" means.
enum class Badness {
  created,   ///< energy that the rendering created, per energy that hand and rotation put in (and 1 mJ)
  vibration  ///< vibration power above 30 Hz times the run's duration [m^2/s]: a run gains nothing by ending early
};

/// Where the hand turns the tool and pushes it at a time; between two of them by cosines, at rest in each.
struct Waypoint {
  double time = 0.0;          ///< [s]
  double tilt = 0.0;          ///< [rad]
  double azimuth = 0.0;       ///< [rad]; 0 in planar scenes
  Vec3 force = Vec3::Zero();  ///< [N]; in the plane in planar scenes
};
using Trajectory = std::vector<Waypoint>;

/// What a hand may do. Every motion lies within, however it was found.
struct TrajectoryBounds {
  double duration = 0.5;  ///< [s]
  std::size_t waypoints = 6;
  double tilt = 0.6;   ///< largest [rad]
  double rate = 2.0;   ///< largest mean rate of tilt and azimuth from one waypoint to the next [rad/s]
  double force = 5.0;  ///< largest norm [N]
};

struct SearchOptions {
  Badness badness = Badness::created;
  std::uint64_t seed = 1;
  std::uint64_t evaluations = 400;  ///< runs of the search; minimising takes at most as many again
  TrajectoryBounds bounds;
  JobOptions jobs;
};

struct SearchResult {
  Trajectory trajectory;          ///< minimised
  Scenario scenario;              ///< which shows it, with an `expect` block that holds
  double found = 0.0;             ///< the badness before minimising
  double badness = 0.0;           ///< of the scenario; at least 90 % of `found`
  double at_rest = 0.0;           ///< of the tool held as it starts, without force: what the scene alone does
  RunSummary run;                 ///< of the scenario; outcome, metrics and energy only
  std::uint64_t evaluations = 0;  ///< runs, all in all
};

/// `scenario` with its orientation and hand replaced by the trajectory, on an ideal device, with energy recorded.
Scenario with_trajectory(Scenario scenario, const Trajectory& trajectory);

/// The badness of a finished run; needs its energy for `created`.
double badness_of(Badness badness, const RunSummary& run);

/// Throws InputError unless the scene is a hole_2d or block_with_hole with a free position.
void check_adversary_scene(const Scenario& scenario);

/// Searches in a scene, from its initial position and orientation on. The same for the same seed, whatever the number
/// of threads. Throws as check_adversary_scene does. Each evaluation costs a run of the scene, at most bounds.duration
/// long.
SearchResult search_adversary(const Scenario& scenario, const SearchOptions& options);

}  // namespace hapbench
