#include "scenarios/batch/seed_axis.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// Random stream of the displacement. It is independent of everything else that the scenario's seed determines.
constexpr std::uint64_t kJitterStream = 0x6a697474;

/// Returns true if the scene is planar: all forces lie in the plane z = 0.
bool lies_in_the_plane(const Environment& environment) {
  if (std::holds_alternative<Hole2d>(environment)) return true;
  const auto* springs = std::get_if<SpringsEnvironment>(&environment);
  if (springs == nullptr || (springs->random.count > 0 && !springs->random.planar)) return false;
  return std::ranges::all_of(springs->groups, [](const SpringGroup& group) { return group.direction.z() == 0.0; });
}

/// Returns a random displacement of the given length [m].
Vec3 start_shift(const Scenario& scenario, double length) {
  Random random(Random::derive(kJitterStream, static_cast<std::uint64_t>(scenario.seed)));
  return length * (lies_in_the_plane(scenario.environment) ? random.direction_in_plane() : random.direction());
}

}  // namespace

Axis seed_axis(const Scenario& scenario, std::size_t seeds, double jitter) {
  Axis axis{"seed"};
  Scenario repetition = scenario;
  for (std::size_t k = 0; k < seeds; ++k, ++repetition.seed) {
    axis.values.push_back(std::to_string(repetition.seed));
    if (jitter == 0.0) continue;
    const Vec3 shift = start_shift(repetition, jitter);
    // A prescribed path is shifted as a whole.
    const auto* path = std::get_if<PrescribedPosition>(&repetition.motion.position);
    const Vec3 start = shift + (path != nullptr ? path->shift.value_or(Vec3::Zero()) : repetition.initial.position);
    axis.along.push_back(
        {{fmt::format("{}=[{},{},{}]", path != nullptr ? "motion.position.shift_m" : "initial.position_m", start.x(),
                      start.y(), start.z())}});
  }
  return axis;
}

}  // namespace hapbench
