#pragma once

#include <optional>
#include <string>
#include <vector>

#include "device_model/theory/stiffness_limits.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/studies/stability/classify.hpp"
#include "scenarios/studies/stability/map_scenes.hpp"

/// Maps of stable, dying, vibrating and diverged runs (classify.hpp), with the analytic limit where there is one.
namespace hapbench {

/// One run of a map.
struct MapPoint {
  double x = 0.0, y = 0.0;
  MotionClass motion = MotionClass::stable;
  double lambda = 0.0;  ///< lambda_max(S) of the first row
  /// SpringDamper::margin; none where the theory does not apply, nor of integrators without a closed form of it.
  std::optional<double> margin;
  /// Of the run from further away; none of maps without (StabilityMap::far).
  std::optional<MotionClass> motion_from_far;
};

/// The edge of the stable runs at one x, as the map defines it (MapEdge).
struct BoundaryPoint {
  double x = 0.0;
  /// In closed form, or of the eigenvalues of a step; with a device in the loop of the eigenvalues of the loop.
  /// Infinite when no y is unstable, none where the theory does not apply.
  std::optional<double> analytic;
  double simulation =
      0.0;  ///< by bisection on runs to 0.1 %; 0, or infinite when there is none up to 1e4 times the map's range
  std::string no_theory;  ///< why there is no analytic limit; empty when there is one
  /// The least edge over hand_family() instead of the map's hand, by eigenvalues; where y is the K of an impedance
  /// device's wall.
  std::optional<double> worst_hand;
  /// As many as stiffness_limits(): the y up to which, or from which, each allows the K of the wall; none where it does
  /// not apply.
  std::vector<std::optional<double>> limits = std::vector<std::optional<double>>(stiffness_limits().size());

  /// simulation / analytic - 1; zero when both are infinite, none without an analytic limit.
  std::optional<double> difference() const;
};

/// What a map is of.
struct MapSubject {
  std::string algorithm;
  const IntegratorEntry* integrator = &kLeapfrog;
  /// Of device and hand (map_overrides.hpp). With motors that saturate, the edge of a map of bounded runs becomes that
  /// of runs that come to rest: they all stay bounded.
  std::vector<std::string> overrides = {};
};

struct MapResult {
  const StabilityMap* map = nullptr;
  MapSubject subject;
  std::size_t size = 0;
  std::vector<MapPoint> points;         ///< size x size, y fastest
  std::vector<BoundaryPoint> boundary;  ///< size
};

/// The map of one algorithm and integrator on a grid of size x size. The same whatever the number of threads.
///
/// The theory applies where the force of the first row is -K S p: then the springs are the linear system whose step the
/// limit is about, alone or with a device and a hand (device_loop.hpp). Precondition: the algorithm is known, the map
/// takes the overrides (require_overridable), size >= 1.
MapResult stability_map(const StabilityMap& map, const MapSubject& subject, std::size_t size,
                        const JobOptions& options);

}  // namespace hapbench
