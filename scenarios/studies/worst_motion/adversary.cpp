#include "scenarios/studies/worst_motion/adversary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "results/summary/outcome_names.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/studies/worst_motion/search_scene.hpp"
#include "scenarios/studies/worst_motion/trajectory_draws.hpp"

namespace hapbench {
namespace {

constexpr double kKept = 0.9;          ///< of the badness, that minimising must keep
constexpr std::size_t kChildren = 16;  ///< of a generation; fixed, so that the search does not depend on the machine
constexpr std::uint64_t kRound = 400;  ///< evaluations of a round
constexpr std::uint64_t kRandomOfARound = 100;  ///< of which are random trajectories
constexpr double kLeastWork = 1e-3;  ///< [J], added to the energy put in, so that doing nothing is not infinitely bad

/// Runs trajectories in one scene.
class Bench {
 public:
  Bench(const SearchScene& scene, Badness badness) : scene_(scene), badness_(badness) {}

  RunSummary run(const Trajectory& trajectory) const {
    LoadedScenario loaded;
    loaded.scenario = with_trajectory(scene_, trajectory);
    loaded.files = NamedFiles(loaded.scenario);
    return run_with_shell(loaded, scene_.shell, std::nullopt, false).summary;
  }
  /// Zero when it is not finite: a search cannot climb there.
  double badness(const Trajectory& trajectory) const {
    const double value = badness_of(badness_, run(trajectory));
    return std::isfinite(value) ? value : 0.0;
  }

  /// The badness of each, on several threads.
  std::vector<double> badness(const std::vector<Trajectory>& trajectories, const JobOptions& jobs) const {
    std::vector<double> all(trajectories.size());
    for_each_job(all.size(), jobs, [&](std::size_t i) { all[i] = badness(trajectories[i]); });
    return all;
  }

 private:
  const SearchScene& scene_;
  Badness badness_;
};

/// The best trajectory so far.
struct Best {
  Trajectory trajectory;
  double badness = -1.0;

  /// Takes the worst-behaved of a batch, the first of equals; false when none is worse than the one it has.
  bool improve(const std::vector<Trajectory>& batch, const std::vector<double>& all) {
    const auto most = std::max_element(all.begin(), all.end());
    if (most == all.end() || !(*most > badness)) return false;
    badness = *most;
    trajectory = batch[static_cast<std::size_t>(most - all.begin())];
    return true;
  }
};

/// One round of the search, from run number `begin` to before `end`.
Best search_round(const Bench& bench, const TrajectoryDraws& draws, const SearchOptions& options, std::uint64_t begin,
                  std::uint64_t end) {
  // Each trajectory draws from a generator seeded by its place in the search, so that threads do not matter.
  const auto random = [&](std::uint64_t run) { return Random(Random::derive(options.seed, run)); };
  Best best;
  std::vector<Trajectory> batch;
  std::uint64_t run = begin;
  for (; run < std::min(end, begin + kRandomOfARound); ++run) {
    Random numbers = random(run);
    batch.push_back(draws.random(numbers));
  }
  best.improve(batch, bench.badness(batch, options.jobs));
  // Steps grow after a success and shrink otherwise.
  double step = 0.3;
  while (run < end) {
    batch.clear();
    for (; batch.size() < kChildren && run < end; ++run) {
      Random numbers = random(run);
      batch.push_back(draws.changed(best.trajectory, step, numbers));
    }
    const bool better = best.improve(batch, bench.badness(batch, options.jobs));
    step = std::clamp(step * (better ? 1.5 : 0.8), 0.01, 1.0);
  }
  return best;
}

/// Round after round, each from new random trajectories, so that one hill does not hide the others: more evaluations
/// never find less.
Best search(const Bench& bench, const TrajectoryDraws& draws, const SearchOptions& options) {
  Best best;
  for (std::uint64_t begin = 0; begin < options.evaluations; begin += kRound) {
    const std::uint64_t end = std::min(options.evaluations, begin + kRound);
    Best round = search_round(bench, draws, options, begin, end);
    if (round.badness > best.badness) best = std::move(round);
  }
  return best;
}

/// Leaves out what the badness does not need, for as long as something can be left out.
void minimise(const Bench& bench, const TrajectoryDraws& draws, std::uint64_t most_runs, Best& best,
              std::uint64_t& runs) {
  const double least = kKept * best.badness;
  const std::uint64_t end = runs + most_runs;
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (std::size_t i = 0; i < draws.simplifications(best.trajectory) && runs < end;) {
      const std::optional<Trajectory> simpler = draws.simplified(best.trajectory, i);
      if (simpler) ++runs;
      const double badness = simpler ? bench.badness(*simpler) : -1.0;
      if (badness >= least) {
        best = {*simpler, badness};
        smaller = true;
      } else {
        ++i;
      }
    }
  }
}

/// A metric of the section "energy" [J], which every run of a search has; infinite when it is not finite.
double energy(const RunSummary& run, const char* metric) {
  return metric_of(run, metric).value_or(std::numeric_limits<double>::infinity());
}

const char* metric_name(Badness badness) {
  return badness == Badness::created ? "energy.created_sum_J" : "vibration_power_above_30Hz_m2_per_s2";
}

/// What the found run shows, with room for another compiler's rounding.
ExpectFields expectation(Badness badness, const RunSummary& run) {
  ExpectFields expect;
  expect.outcomes = {run.result.outcome};
  const double value =
      badness == Badness::created ? energy(run, "energy.created_sum_J") : run.metrics.vibration_power.value_or(0.0);
  expect.metrics[metric_name(badness)] = MetricBound{kKept * value, std::nullopt};
  return expect;
}

}  // namespace

double badness_of(Badness badness, const RunSummary& run) {
  if (badness == Badness::vibration) return run.duration * run.metrics.vibration_power.value_or(0.0);
  const double put_in =
      std::max(0.0, energy(run, "energy.input_J")) + std::max(0.0, energy(run, "energy.rotation_J")) + kLeastWork;
  return energy(run, "energy.created_sum_J") / put_in;
}

SearchResult search_adversary(const Scenario& scenario, const SearchOptions& options) {
  const SearchScene scene = search_scene(scenario);
  const OrientationFields& orientation = *scenario.motion.orientation;
  const TrajectoryDraws draws(options.bounds, scene.planar, orientation.tilt(0.0), orientation.azimuth(0.0));
  const Bench bench(scene, options.badness);

  SearchResult result;
  result.at_rest = bench.badness(draws.at_rest());
  Best best = search(bench, draws, options);
  result.evaluations = options.evaluations;
  result.found = best.badness;
  minimise(bench, draws, options.evaluations, best, result.evaluations);
  result.evaluations += 2;
  result.badness = best.badness;
  result.trajectory = best.trajectory;
  result.run = bench.run(best.trajectory);
  result.scenario = with_trajectory(scene, best.trajectory);
  result.scenario.expect = expectation(options.badness, result.run);
  return result;
}

}  // namespace hapbench
