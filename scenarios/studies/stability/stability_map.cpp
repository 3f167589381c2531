#include "scenarios/studies/stability/stability_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"
#include "sim/core/bisection.hpp"

namespace hapbench {
namespace {

/// A twentieth of the 2 % within which theory and runs must agree.
constexpr double kMapPrecision = 1e-3;

/// How far beyond a map's range an edge is looked for. Further out, from K dt^2 / M = 6e8 on, the rounding of a step of
/// implicit_midpoint, which damps nothing there, grows.
constexpr double kBeyondTheMap = 1e4;

/// The first row: where the springs start from.
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
  MotionClass motion;
  Vec3 lambdas;  ///< eigenvalues of S, ascending
  bool linear;   ///< the force is -K S p
};

Probe probe(const Scenario& scenario) {
  FirstRow first;
  MotionClassifier classifier(static_cast<std::uint64_t>(scenario.time.steps));
  Simulation simulation(simulation_config(scenario), assemble(scenario), {&first, &classifier});
  const MotionClass motion = classify(simulation, classifier);
  const double K = scenario.rendering.stiffness;
  // Sums of up to a hundred springs; exact_shaping's weights are good to 1e-12.
  const double rounding = 1e-10 * K * (1.0 + first.S.norm()) * first.position.norm();
  const bool linear = (first.spring + K * (first.S * first.position)).norm() <= rounding;
  return {motion, Eigen::SelfAdjointEigenSolver<Mat3>(first.S, Eigen::EigenvaluesOnly).eigenvalues(), linear};
}

Scenario scene(const StabilityMap& map, const MapSubject& subject, double x, double y) {
  Scenario scenario = map.scene(x, y, subject.algorithm);
  scenario.integrator.type = subject.integrator;
  return scenario;
}

MapPoint map_point(const StabilityMap& map, const MapSubject& subject, double x, double y) {
  const Scenario scenario = scene(map, subject, x, y);
  const Probe run = probe(scenario);
  MapPoint point{x, y, run.motion, run.lambdas[2], {}};
  if (map.no_theory != nullptr || !run.linear) return point;
  const double K = scenario.rendering.stiffness, M = scenario.rendering.mass;
  const double B = 2.0 * scenario.rendering.damping_ratio * std::sqrt(K * M);
  point.margin = SpringDamper{K, B, M, scenario.time.step, run.lambdas[2], subject.integrator}.margin();
  return point;
}

/// The least limit of the modes of the springs. Under leapfrog it is that of the stiffest; a softer one is damped less,
/// which under velocity Verlet may end it first.
double theory_of(const Scenario& start, const Vec3& lambdas) {
  constexpr auto kCase = StabilityCase::stiffness_damped;
  double least = std::numeric_limits<double>::infinity();
  for (const double lambda : lambdas) {
    const std::optional<double> closed = analytic_limit(kCase, start, lambda);
    least = std::min(least, closed ? *closed : eigenvalue_limit(kCase, start, lambda, start.rendering.stiffness));
  }
  return least;
}

BoundaryPoint boundary_point(const StabilityMap& map, const MapSubject& subject, double x) {
  BoundaryPoint point;
  point.x = x;
  const auto holds = [&](double y) {
    const MotionClass motion = probe(scene(map, subject, x, y)).motion;
    return map.no_theory == nullptr ? motion != MotionClass::diverged : comes_to_rest(motion);
  };
  point.simulation = largest_stable(map.y.low, kMapPrecision, holds, kBeyondTheMap * map.y.high);
  if (map.no_theory != nullptr) {
    point.no_theory = map.no_theory;
    return point;
  }
  const Scenario start = scene(map, subject, x, map.y.low);
  const Probe run = probe(start);
  if (run.linear) {
    point.analytic = theory_of(start, run.lambdas);
  } else {
    point.no_theory = "the force is not -K S p";
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
