#include "scenarios/scene/trials.hpp"

#include <variant>

#include "sim/core/random.hpp"

namespace hapbench {

std::vector<Trial> trials_of(const Scenario& scenario) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  if (hand == nullptr) return {Trial{}};
  std::vector<Trial> trials;
  for (std::size_t subject = 0; subject < hand->subjects.size(); ++subject)
    for (std::size_t number = 0; number < static_cast<std::size_t>(hand->trials); ++number)
      trials.push_back({subject, number});
  return trials;
}

std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use) {
  std::uint64_t seed = static_cast<std::uint64_t>(scenario.seed);
  for (const std::uint64_t part :
       {static_cast<std::uint64_t>(use), std::uint64_t{trial.subject}, std::uint64_t{trial.number}}) {
    seed = Random::derive(seed ^ (seed >> 29), part);
  }
  return seed;
}

}  // namespace hapbench
