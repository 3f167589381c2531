#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/description/load_scenario.hpp"

/// Scenes sampled more finely, for converge and compare --errors.
namespace hapbench {

/// The field that sets the distance of the shell's points, and this distance.
struct PointDistance {
  const char* path;  ///< of the field, as in --set
  double metres;
  bool is_given = true;  ///< false: the mean distance of the vertices of a mesh that is taken as it is
};

/// None where no field sets it.
std::optional<PointDistance> point_distance(const LoadedScenario& loaded);

/// The overrides of a scenario sampled more finely.
struct FinerScene {
  std::vector<std::string> overrides = {};
  std::int64_t stride = 1;  ///< TimeFields::stride, so that metrics are taken at the times of the coarse rows
};

/// A step so many times shorter, first among the overrides, over the same time; delays of devices keep their length.
FinerScene with_finer_step(const Scenario& scenario, int times);

}  // namespace hapbench
