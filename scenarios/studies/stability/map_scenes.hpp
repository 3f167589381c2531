#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "scenarios/description/scenario.hpp"

/// The scenes behind `hapbench stability --map`: two numbers to vary, everything else as on the platform (M = 0.1 kg,
/// step 0.5 ms, zeta = 0.7).
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

struct StabilityMap {
  const char* name;
  const char* summary;
  MapAxis x, y;
  /// The scenario at (x, y) for an algorithm. The y of the spring maps is K.
  Scenario (*scene)(double x, double y, std::string_view algorithm);
  /// Null where the tool is alone with springs that stay in contact; else why no limit is known.
  const char* no_theory;
};

/// Steps of one run of a map.
inline constexpr std::int64_t kMapSteps = 8000;

std::span<const StabilityMap> stability_maps();
/// Null when there is no such map.
const StabilityMap* find_stability_map(std::string_view name);

}  // namespace hapbench
