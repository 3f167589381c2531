#pragma once

#include <cstddef>
#include <cstdint>

#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// One run of a scenario that has several: a simulated subject's trial. Both count from 0.
struct Trial {
  std::size_t subject = 0;
  std::size_t number = 0;
};

/// The uses of randomness that differ from trial to trial, by numbers on which seeds depend.
enum class RandomUse { sensor_noise = 1, motor_noise, target_order, position_noise, lost_queries, tremor };
/// A seed of its own for each use in each trial: far apart in the 64 bits, whatever the scenario's seed.
std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use);

}  // namespace hapbench
