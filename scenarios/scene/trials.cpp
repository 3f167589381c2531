#include "scenarios/scene/trials.hpp"

#include "sim/core/random.hpp"

namespace hapbench {

std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use) {
  std::uint64_t seed = static_cast<std::uint64_t>(scenario.seed);
  for (const std::uint64_t part :
       {static_cast<std::uint64_t>(use), std::uint64_t{trial.subject}, std::uint64_t{trial.number}}) {
    seed = Random::derive(seed ^ (seed >> 29), part);
  }
  return seed;
}

}  // namespace hapbench
