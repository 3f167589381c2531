#include "scenarios/studies/stability/stability_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"
#include "sim/core/bisection.hpp"

namespace hapbench {
namespace {

/// An edge is looked for up to this factor beyond a map's range. Further out, from K dt^2 / M = 6e8 on, the rounding of
/// a step of implicit_midpoint, which damps nothing there, grows.
constexpr double kBeyondTheMap = 1e4;
/// The edge of a loop is looked for from this factor below the range.
constexpr double kBelowTheMap = 1e-3;

/// Precision in y of limits in closed form that are given in another number than y.
constexpr double kLimitPrecision = 1e-9;

/// Keeps the first row: the springs at the start.
class FirstRow final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    if (record.step != 0) return;
    S = record.force.S;
    spring = record.force.spring;
    position = record.tool.pose.position;
  }
  Mat3 S = Mat3::Zero();
  Vec3 spring = Vec3::Zero();
  Vec3 position = Vec3::Zero();
};

struct Probe {
  RunVerdict verdict;
  Vec3 lambdas;  ///< eigenvalues of S, ascending
  bool linear;   ///< true when the force is -K S p
};

/// The tool held on its wall by friction that lets nothing slide, and struck along it: by so much more than the wall is
/// deep that no motion across the wall, where a late force begins with a jerk, counts.
Scenario struck_along_wall(Scenario scenario, const Mat3& S) {
  constexpr double kDepth = 1e-8, kStrike = 1e-2;  // [m], [m/s]
  const Vec3 u = make_springs(scenario).gradients.front();
  const Vec3 place = kDepth * u, push = scenario.rendering.stiffness * S * place;
  std::get<SpringsEnvironment>(scenario.environment).bilateral = false;
  scenario.rendering.dry_friction->mu = 1e12;
  if (auto* held = std::get_if<MassSpringDamperHandFields>(&scenario.hand)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      held->spring.target[i] = place[j] + push[j] / held->spring.stiffness;
    }
  } else {
    auto& hand = scenario.hand.emplace<ForceHandFields>();
    for (std::size_t i = 0; i < 3; ++i) hand.force[i] = push[static_cast<Eigen::Index>(i)];
  }
  scenario.initial.position = place;
  scenario.initial.velocity = kStrike * u.unitOrthogonal();
  return scenario;
}

JudgedRun judged(const Scenario& scenario) {
  LoadedScenario loaded;
  loaded.scenario = scenario;
  return judged_run(loaded, nullptr);
}

/// The worse of the runs across the wall and, with dry friction, along it.
Probe probe(const StabilityMap& map, const Scenario& given) {
  Scenario scenario = given;
  scenario.rendering.dry_friction.reset();  // a wall that pulls has no load
  FirstRow first;
  Simulation(simulation_config(scenario), assemble(scenario), {&first}).step();
  JudgedRun run = judged(scenario);
  if (given.rendering.dry_friction)
    run.verdict = std::max(run.verdict, judged(struck_along_wall(given, first.S)).verdict);
  if (map.friction_stops && is_stable(run.verdict) && !run.at_rest) run.verdict = RunVerdict::vibrating;
  const double K = scenario.rendering.stiffness;
  // Sums of up to a hundred springs; exact_shaping's weights are good to 1e-12.
  const double rounding = 1e-10 * K * (1.0 + first.S.norm()) * first.position.norm();
  const bool linear = (first.spring + K * (first.S * first.position)).norm() <= rounding;
  return {run.verdict, Eigen::SelfAdjointEigenSolver<Mat3>(first.S, Eigen::EigenvaluesOnly).eigenvalues(), linear};
}

/// True when no device and no hand take part in the motion of the tool on the springs.
bool is_alone(const Scenario& scenario) {
  return std::holds_alternative<IdealDeviceFields>(scenario.device);
}

Scenario scene(const StabilityMap& map, const MapSubject& subject, double x, double y) {
  Scenario scenario = map.scene(x, y, subject.algorithm);
  scenario.integrator.type = subject.integrator;
  return subject.overrides.empty() ? scenario : with_overrides(map, std::move(scenario), subject.overrides);
}

MapPoint map_point(const StabilityMap& map, const MapSubject& subject, double x, double y) {
  const Scenario scenario = scene(map, subject, x, y);
  const Probe run = probe(map, scenario);
  MapPoint point{x, y, run.verdict, run.lambdas[2], {}, {}};
  if (map.far) {
    Scenario far = scenario;
    far.initial.position *= *map.far;
    point.verdict_from_far = probe(map, far).verdict;
  }
  if (!is_alone(scenario) || !run.linear || scenario.rendering.force_stage) return point;
  point.margin = tool_on_spring(scenario, run.lambdas[2]).margin();
  if (scenario.rendering.dry_friction)
    point.margin = std::min(point.margin, tool_on_spring(stuck_scene(scenario), 1.0).margin());
  return point;
}

/// The least limit of the modes of the springs. Under leapfrog the stiffest mode has it; a softer one is damped less
/// and may become unstable first under velocity Verlet.
double theory_of(const Scenario& start, const Vec3& lambdas) {
  constexpr auto kCase = StabilityCase::stiffness_damped;
  double least = std::numeric_limits<double>::infinity();
  for (const double lambda : lambdas) {
    const std::optional<double> closed = analytic_limit(kCase, start, lambda);
    least = std::min(least, closed ? *closed : eigenvalue_limit(kCase, start, lambda, start.rendering.stiffness));
  }
  return least;
}

/// The y up to which, or from which, something holds; zero or infinite as in BoundaryPoint.
template <class Holds>
double edge_in_y(const StabilityMap& map, double precision, Holds holds) {
  if (map.edge != MapEdge::smallest_at_rest)
    return largest_stable(map.y.low, precision, holds, kBeyondTheMap * map.y.high);
  const auto holds_at_inverse = [&holds](double inverse) { return holds(1.0 / inverse); };
  return 1.0 / largest_stable(1.0 / map.y.high, precision, holds_at_inverse, kBeyondTheMap / map.y.low);
}

/// Adds what is known in theory of the loops along one x, in which the wall is lambda K, lambda B.
void add_loop_theory(const StabilityMap& map, const MapSubject& subject, double lambda, BoundaryPoint& point) {
  const auto loop_at = [&](double y) { return device_loop(scene(map, subject, point.x, y), lambda); };
  const DeviceLoop start = loop_at(map.y.low);
  point.no_theory = start.no_theory;
  if (start.no_theory.empty()) {
    point.analytic = first_edge(kBelowTheMap * map.y.low, kBeyondTheMap * map.y.high,
                                [&](double y) { return loop_at(y).state_matrix(); });
  }
  const auto* sampled = std::get_if<SampledLoop>(&start.loop);
  if (sampled == nullptr || !unknown_to_theory(scene(map, subject, point.x, map.y.low)).empty()) return;
  if (start.no_theory.empty() && map.has_stiffness_as_y()) point.worst_hand = worst_hand_edge(*sampled) / lambda;
  for (std::size_t i = 0; i < point.limits.size(); ++i) {
    const auto largest = stiffness_limits()[i].largest;
    if (map.has_stiffness_as_y()) {
      const std::optional<double> K = largest(*sampled);
      if (K) point.limits[i] = *K / lambda;
      continue;
    }
    const double edge = edge_in_y(map, kLimitPrecision, [&](double y) {
      const SampledLoop loop = std::get<SampledLoop>(loop_at(y).loop);
      const std::optional<double> K = largest(loop);
      return K && loop.stiffness <= *K;
    });
    if (edge > 0.0 && std::isfinite(edge)) point.limits[i] = edge;
  }
}

/// The edge along a wall of the tool that dry friction holds on it.
double tangent_of(const StabilityMap& map, const MapSubject& subject, double x) {
  return first_edge_of(kBelowTheMap * map.y.low, kBeyondTheMap * map.y.high, [&](double y) {
    const Scenario stuck = stuck_scene(scene(map, subject, x, y));
    return is_alone(stuck) ? tool_on_spring(stuck, 1.0).is_stable()
                           : is_stable_step(device_loop(stuck, 1.0).state_matrix());
  });
}

/// True where motors saturate and so keep every run bounded, however unstable it is.
bool saturates(const Scenario& scenario) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  return device != nullptr && device->force_max.has_value();
}

BoundaryPoint boundary_point(const StabilityMap& map, const MapSubject& subject, double x) {
  BoundaryPoint point;
  point.x = x;
  const Scenario start = scene(map, subject, x, map.y.low);
  const bool is_of_bounded = map.edge == MapEdge::largest_bounded && !saturates(start);
  point.simulation = edge_in_y(map, kMapPrecision, [&](double y) {
    const RunVerdict verdict = probe(map, scene(map, subject, x, y)).verdict;
    return is_stable(verdict) || (is_of_bounded && verdict == RunVerdict::vibrating);
  });
  const Probe run = probe(map, start);
  if (start.rendering.force_stage) {
    point.no_theory = "a force stage changes the force";
  } else if (!run.linear) {
    point.no_theory = "the force is not -K S p";
  } else if (is_alone(start)) {
    point.analytic = theory_of(start, run.lambdas);
  } else {
    add_loop_theory(map, subject, run.lambdas[2], point);
  }
  if (start.rendering.dry_friction && point.no_theory.empty()) point.tangent = tangent_of(map, subject, x);
  return point;
}

}  // namespace

std::optional<double> BoundaryPoint::theory() const {
  return tangent ? std::min(analytic, tangent) : analytic;
}

std::optional<double> BoundaryPoint::difference() const {
  const std::optional<double> edge = theory();
  if (!edge) return std::nullopt;
  return *edge == simulation ? 0.0 : simulation / *edge - 1.0;
}

MapResult stability_map(const StabilityMap& map, const MapSubject& subject, std::size_t size,
                        const JobOptions& options) {
  MapResult result{&map, subject, size, {}, {}};
  result.points.resize(size * size);
  result.boundary.resize(size);
  for_each_job(size * size + size, options, [&](std::size_t i) {
    if (i < size * size) {
      result.points[i] = map_point(map, subject, map.x.at(i / size, size), map.y.at(i % size, size));
    } else {
      result.boundary[i - size * size] = boundary_point(map, subject, map.x.at(i - size * size, size));
    }
  });
  return result;
}

}  // namespace hapbench
