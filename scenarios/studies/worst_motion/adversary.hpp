#pragma once

#include <cstdint>

#include "results/summary/summary.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/studies/worst_motion/trajectory.hpp"

/// Looks for the motion of the hand that an algorithm renders worst: a seeded random search; then an evolution
/// (1 + lambda), in which the best of several slightly changed copies replaces the motion if it is worse rendered; then
/// a simplification that removes what the motion does not need.
namespace hapbench {

/// What "worst" means.
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
  Scenario scenario;              ///< which shows it, with an `expect` block that holds
  double found = 0.0;             ///< the badness before minimising
  double badness = 0.0;           ///< of the scenario; at least 90 % of `found`
  double at_rest = 0.0;           ///< of the tool held as it starts, without force: what the scene alone does
  RunSummary run;                 ///< of the scenario; outcome, metrics and energy only
  std::uint64_t evaluations = 0;  ///< runs, all in all
};

/// The badness of a finished run; needs its energy for `created`.
double badness_of(Badness badness, const RunSummary& run);

/// Searches in a scene, from where search_scene.hpp puts its tool. The same for the same seed, whatever the number of
/// threads. Throws as search_scene does. Each evaluation costs a run of the scene, at most bounds.duration long.
SearchResult search_adversary(const Scenario& scenario, const SearchOptions& options);

}  // namespace hapbench
