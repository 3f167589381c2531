#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device_model/theory/stiffness_limits.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/scenario.hpp"
#include "scenarios/studies/stability/judged_run.hpp"

/// Maps of the verdicts on runs (judged_run.hpp), with the analytic limit where there is one, and
/// the scenes behind `hapbench stability --map`: two numbers vary, everything else is as on the platform (M = 0.1 kg,
/// step 0.5 ms, zeta = 0.7), and for the impedance device as stated in map_scenes.cpp.
namespace hapbench {

/// One of the two numbers of a map.
struct MapAxis {
  const char* name;  ///< with the unit, as a column of the CSV
  double low, high;
  enum class Scale { linear, logarithmic } scale;
  bool whole = false;  ///< true for integers

  /// The i-th of n values, 0 <= i < n.
  double at(std::size_t i, std::size_t n) const noexcept;
};

/// The y at which the edge of a map lies.
enum class MapEdge {
  largest_bounded,  ///< the largest whose run does not diverge
  largest_at_rest,  ///< the largest whose run comes to rest
  smallest_at_rest  ///< the smallest whose run comes to rest
};

struct StabilityMap {
  const char* name;
  const char* summary;
  MapAxis x, y;
  /// The scenario at (x, y) for an algorithm. Springs under an ideal device stay in contact, so that the step of the
  /// integrator has a limit in theory; other devices have the limit of their loop (DeviceLoop).
  Scenario (*scene)(double x, double y, std::string_view algorithm);
  MapEdge edge = MapEdge::largest_bounded;
  /// If set, every cell has a second run that begins so many times as far from rest.
  std::optional<double> far = std::nullopt;
  /// True where dry friction stops the handle for good: there a handle that still moves in the end, however little,
  /// vibrates.
  bool friction_stops = false;
  /// True where the axes are in units of the device's own numbers, which then cannot be overridden.
  bool in_units_of_device = false;

  /// True when y is the stiffness K of the wall.
  bool has_stiffness_as_y() const noexcept { return std::string_view(y.name) == kStiffnessAxis; }
  static constexpr std::string_view kStiffnessAxis = "stiffness_N_per_m";
};

/// Steps of one run of a map.
inline constexpr std::int64_t kMapSteps = 8000;

std::span<const StabilityMap> stability_maps();
/// Null when there is no such map.
const StabilityMap* find_stability_map(std::string_view name);

/// Checks overrides `path=value` (as of `--set`) for a map of the user's own device and hand: of time.step_s and of the
/// fields of `device` and `hand`, or of either as a whole; every map takes a force stage, and those of one wall whose
/// loop is linear take dry friction, which then holds the tool in runs along the wall. Where the whole
/// device is given, the axes still set the fields that they vary. Throws InputError for a map without an impedance
/// device or whose axes are in units of its own one, for another field or one that an axis varies, and for a value that
/// the field does not take.
void require_overridable(const StabilityMap& map, const std::vector<std::string>& overrides);

/// A scene of the map with the overrides; only its time step, device, hand, force stage and friction change.
/// Precondition: require_overridable accepts them.
Scenario with_overrides(const StabilityMap& map, Scenario scenario, const std::vector<std::string>& overrides);

/// One run of a map.
struct MapPoint {
  double x = 0.0, y = 0.0;
  RunVerdict verdict = RunVerdict::stable;
  double lambda = 0.0;  ///< lambda_max(S) of the first row
  /// SpringDamper::margin; empty where the theory does not apply and for integrators without a closed form of it.
  std::optional<double> margin;
  /// That on the run from further away; empty in maps without such runs (StabilityMap::far).
  std::optional<RunVerdict> verdict_from_far;
};

/// Relative width at which the bisection on runs stops: a twentieth of the 2 % within which theory and runs must agree.
inline constexpr double kMapPrecision = 1e-3;

/// The edge of the stable runs at one x, as the map defines it (MapEdge).
struct BoundaryPoint {
  double x = 0.0;
  /// In closed form, or by the eigenvalues of a step, or of the loop when a device is in it. Infinite when no y is
  /// unstable, empty where the theory does not apply.
  std::optional<double> analytic;
  /// With dry friction: the edge along the wall, of the bristle in place of the springs. `analytic` is across it.
  std::optional<double> tangent;
  /// By bisection on runs to 0.1 %; 0, or infinite when there is no edge up to 1e4 times the map's range.
  double simulation = 0.0;
  std::string no_theory;  ///< why there is no analytic limit; empty when there is one
  /// The least edge over hand_family() instead of the map's hand, by eigenvalues; only where y is the K of an impedance
  /// device's wall.
  std::optional<double> worst_hand;
  /// As many as stiffness_limits(): the y up to which, or from which, each allows the K of the wall; empty where it
  /// does not apply.
  std::vector<std::optional<double>> limits = std::vector<std::optional<double>>(stiffness_limits().size());

  /// The lesser of the edges in theory.
  std::optional<double> theory() const;
  /// simulation / theory() - 1; zero when both are infinite, empty without theory.
  std::optional<double> difference() const;
};

/// The algorithm, integrator and device that a map shows.
struct MapSubject {
  std::string algorithm;
  const IntegratorEntry* integrator = &kLeapfrog;
  /// Overrides of device and hand (require_overridable). With motors that saturate, the edge of a map of bounded runs
  /// becomes that of runs that come to rest: they all stay bounded.
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
/// limit is about, alone or with a device and a hand (DeviceLoop). Precondition: the algorithm is known, the map
/// takes the overrides (require_overridable), size >= 1.
MapResult stability_map(const StabilityMap& map, const MapSubject& subject, std::size_t size,
                        const JobOptions& options);

}  // namespace hapbench
