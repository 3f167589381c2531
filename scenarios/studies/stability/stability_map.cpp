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

Probe probe(const StabilityMap& map, const Scenario& scenario) {
  FirstRow first;
  Simulation(simulation_config(scenario), assemble(scenario), {&first}).step();
  LoadedScenario loaded;
  loaded.scenario = scenario;
  JudgedRun run = judged_run(loaded, nullptr);
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
  const double K = scenario.rendering.stiffness, M = scenario.rendering.mass;
  const double B = 2.0 * scenario.rendering.damping_ratio * std::sqrt(K * M);
  const SpringDamper stiffest{
      .K = K, .B = B, .M = M, .dt = scenario.time.step, .lambda = run.lambdas[2], .integrator = subject.integrator};
  point.margin = stiffest.margin();
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
  if (sampled == nullptr) return;
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
  return point;
}

}  // namespace

std::optional<double> BoundaryPoint::difference() const {
  if (!analytic) return std::nullopt;
  return *analytic == simulation ? 0.0 : simulation / *analytic - 1.0;
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
