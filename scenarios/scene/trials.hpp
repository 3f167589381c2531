#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Identifies a trial of a simulated subject. A scenario without subjects has a single trial, Trial{0, 0}.
struct Trial {
  std::size_t subject = 0;  ///< index of the subject, from 0
  std::size_t number = 0;   ///< index of the subject's trial, from 0
};

/// Returns the trials of a scenario, subject by subject. Only a tracking hand has more than one trial.
std::vector<Trial> trials_of(const Scenario& scenario);

/// Purposes of random numbers. Each trial has a seed for each purpose. Seeds depend on the numeric values; do not
/// renumber.
enum class RandomUse { sensor_noise = 1, motor_noise, target_order, position_noise, lost_queries, tremor };
/// Returns a 64-bit seed for one use of random numbers in one trial. Different uses, trials and scenario seeds
/// give unrelated seeds.
std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use);

}  // namespace hapbench
