#include "scenarios/studies/worst_motion/adversary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/run_scenario.hpp"

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

/// The place where the scene's tool, moved without turning, first touches the shell.
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
    // In statements of their own: compilers take the operands of a product in either order.
    const Vec3 direction = planar_ ? random.direction_in_plane() : random.direction();
    w.force = bounds_.force * random.uniform() * direction;
  }
  return within_bounds(std::move(trajectory));
}

Trajectory TrajectoryDraws::changed(Trajectory from, double step, Random& random) const {
  const double ranges[kNumbers] = {bounds_.tilt, bounds_.rate * bounds_.duration, bounds_.force, bounds_.force,
                                   bounds_.force};
  for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
    const std::size_t i = random.below(kNumbers);
    const double change = step * ranges[i] * random.normal();
    number(from[random.below(from.size())], i) += change;
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
  double badness(const Trajectory& trajectory) const { return finite_badness(run(trajectory)); }

  /// The badness of each, on several threads; counts how the runs end.
  std::vector<double> badness(const std::vector<Trajectory>& trajectories, const JobOptions& jobs) {
    std::vector<double> all(trajectories.size());
    std::vector<Outcome> ends(trajectories.size());
    for_each_job(all.size(), jobs, [&](std::size_t i) {
      const RunSummary summary = run(trajectories[i]);
      all[i] = finite_badness(summary);
      ends[i] = summary.result.outcome;
    });
    for (const Outcome end : ends) ++outcomes_[end];
    return all;
  }
  const std::map<Outcome, std::uint64_t>& outcomes() const { return outcomes_; }

 private:
  /// Zero when it is not finite: a search cannot climb there.
  double finite_badness(const RunSummary& summary) const {
    const double value = badness_of(badness_, summary);
    return std::isfinite(value) ? value : 0.0;
  }

  const SearchScene& scene_;
  Badness badness_;
  std::map<Outcome, std::uint64_t> outcomes_;
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
Best search_round(Bench& bench, const TrajectoryDraws& draws, const SearchOptions& options, std::uint64_t begin,
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
Best search(Bench& bench, const TrajectoryDraws& draws, const SearchOptions& options) {
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

/// The outcome and the metric of the found run, with room for another compiler's rounding.
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
  Bench bench(scene, options.badness);

  SearchResult result;
  result.at_rest = bench.badness(draws.at_rest());
  Best best = search(bench, draws, options);
  result.evaluations = options.evaluations;
  result.outcomes = bench.outcomes();
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
