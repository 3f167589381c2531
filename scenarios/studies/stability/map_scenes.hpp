#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "scenarios/description/scenario.hpp"

/// The scenes behind `hapbench stability --map`: two numbers to vary, everything else as on the platform (M = 0.1 kg,
/// step 0.5 ms, zeta = 0.7), and for the impedance device as stated in map_scenes.cpp.
namespace hapbench {

/// One of the two numbers of a map.
struct MapAxis {
  const char* name;  ///< with the unit, as a column of the CSV
  double low, high;
  enum class Scale { linear, logarithmic } scale;
  bool whole = false;  ///< numbers, rounded

  /// The i-th of n values, 0 <= i < n.
  double at(std::size_t i, std::size_t n) const noexcept;
};

/// Which y the edge of a map is.
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
  /// integrator has a limit in theory; other devices have that of their loop (device_loop.hpp).
  Scenario (*scene)(double x, double y, std::string_view algorithm);
  MapEdge edge = MapEdge::largest_bounded;
  /// Where it matters how far a run begins from rest, every cell has a second run from so many times as far.
  std::optional<double> far = std::nullopt;
  /// True where dry friction stops the handle for good: there what still moves in the end, however little, vibrates.
  bool friction_stops = false;
  /// True where the axes are in units of numbers of the device, which then cannot be other ones.
  bool in_units_of_device = false;

  /// True when y is the K of the wall, which limits of the stiffness are about.
  bool has_stiffness_as_y() const noexcept { return std::string_view(y.name) == kStiffnessAxis; }
  static constexpr std::string_view kStiffnessAxis = "stiffness_N_per_m";
};

/// Steps of one run of a map.
inline constexpr std::int64_t kMapSteps = 8000;

std::span<const StabilityMap> stability_maps();
/// Null when there is no such map.
const StabilityMap* find_stability_map(std::string_view name);

}  // namespace hapbench
