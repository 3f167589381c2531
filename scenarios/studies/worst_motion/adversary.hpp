#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/core/random.hpp"
#include "sim/core/types.hpp"
#include "sim/geometry/point_shell.hpp"

/// Looks for the motion of the hand that an algorithm renders worst: a seeded random search; then an evolution
/// (1 + lambda), in which the best of several slightly changed copies replaces the motion if it is rendered worse; then
/// a simplification that removes what the motion does not need.
namespace hapbench {

/// The tool's orientation and the hand's force at a time. Between waypoints both follow cosines, at rest in each.
struct Waypoint {
  double time = 0.0;          ///< [s]
  double tilt = 0.0;          ///< [rad]
  double azimuth = 0.0;       ///< [rad]; 0 in planar scenes
  Vec3 force = Vec3::Zero();  ///< [N]; in the plane in planar scenes
};
using Trajectory = std::vector<Waypoint>;

/// The bounds of a hand. Every motion lies within them, however it was found.
struct TrajectoryBounds {
  double duration = 0.5;  ///< [s]
  std::size_t waypoints = 6;
  double tilt = 0.6;   ///< largest [rad]
  double rate = 2.0;   ///< largest mean rate of tilt and azimuth from one waypoint to the next [rad/s]
  double force = 5.0;  ///< largest norm [N]
};

/// The trajectories a search may try: all within the bounds, all beginning with the same orientation, all with numbers
/// that are short to write (1 ms, 0.1 mrad, 1 mN).
class TrajectoryDraws {
 public:
  /// Planar: no azimuth, no force along z. `tilt`, `azimuth`: at the beginning [rad]; a tilt beyond the bounds may stay
  /// until the first waypoint after it.
  TrajectoryDraws(const TrajectoryBounds& bounds, bool planar, double tilt, double azimuth)
      : bounds_(bounds), planar_(planar), tilt_(tilt), azimuth_(azimuth) {}

  /// No motion and no force.
  Trajectory at_rest() const;
  Trajectory random(Random& random) const;
  /// One to three numbers of `from` moved by about `step` of their ranges.
  Trajectory changed(Trajectory from, double step, Random& random) const;

  /// How many ways to simplify a trajectory there are: an end cut off, a waypoint left out, a number made zero.
  std::size_t simplifications(const Trajectory& trajectory) const;
  /// The i-th of them; empty when it would change nothing.
  std::optional<Trajectory> simplified(const Trajectory& trajectory, std::size_t i) const;

 private:
  Trajectory within_bounds(Trajectory trajectory) const;

  TrajectoryBounds bounds_;
  bool planar_;
  double tilt_, azimuth_;
};

/// A scene as the search for the worst motion needs it: a tool at a surface, and a hand that stays there.
struct SearchScene {
  Scenario scenario;  ///< where the tool touches the surface from the start, or is where the scenario has it in a hole
  std::shared_ptr<const PointShell> shell;
  bool planar = false;  ///< all lies in z = 0
  /// The box where the hand may aim [m]: the box around the shell, one tool diameter wider. Empty in a hole, whose
  /// walls hold the tool.
  std::optional<Box> reach;
};

/// Throws InputError unless the scene has a shell, a free position and a time step that is not too fine.
void check_search_scene(const Scenario& scenario);

/// The scene of a search. A tool that starts apart from a surface that is no hole is set against it, on the straight
/// way to the shell's nearest point. Throws as check_search_scene does, and for an empty shell.
SearchScene search_scene(const Scenario& scenario);

/// The scene with its orientation and hand replaced by the trajectory, on an ideal device, with energy recorded. In a
/// hole the hand pushes with the trajectory's force. Elsewhere it does so where the tool starts and less further on, by
/// a spring of 300 N/m whose end stays within reach, so that the tool does not get lost.
Scenario with_trajectory(const SearchScene& scene, const Trajectory& trajectory);

/// The meaning of "worst".
enum class Badness {
  created,   ///< energy that the rendering created, per energy that hand and rotation put in (and 1 mJ)
  vibration  ///< vibration power above 30 Hz times the run's duration [m^2/s]: a run gains nothing by ending early
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
  Scenario scenario;              ///< shows the motion, with an `expect` block that holds
  double found = 0.0;             ///< the badness before minimising
  double badness = 0.0;           ///< of the scenario; at least 90 % of `found`
  double at_rest = 0.0;           ///< of the tool held as it starts, without force
  RunSummary run;                 ///< of the scenario; outcome, metrics and energy only
  std::uint64_t evaluations = 0;  ///< runs, all in all
  /// How the runs of the search ended, before minimising: a motion in which the tool goes through the surface or never
  /// touches it says little about a law, however bad it is.
  std::map<Outcome, std::uint64_t> outcomes;
};

/// The badness of a finished run; needs its energy for `created`.
double badness_of(Badness badness, const RunSummary& run);

/// Searches in a scene, from where search_scene puts its tool. The same for the same seed, whatever the number of
/// threads. Throws as search_scene does. Each evaluation costs a run of the scene, at most bounds.duration long.
SearchResult search_adversary(const Scenario& scenario, const SearchOptions& options);

}  // namespace hapbench
