#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <vector>

#include "scenarios/description/scenario.hpp"
#include "sim/contact/contact_buffer.hpp"

/// The contacts that a drill has in a hole, set by set, and how long a force law takes over them.
namespace hapbench {

/// Seconds per call of `work`, which makes `calls` calls; the least of `repetitions`, or of as many as a second allows.
template <class Work>
double seconds_per_call(std::size_t calls, int repetitions, Work work) {
  using Clock = std::chrono::steady_clock;
  double least = 0.0, all = 0.0;
  for (int i = 0; i < repetitions && all < 1.0; ++i) {
    const auto start = Clock::now();
    work();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (i == 0 || seconds < least) least = seconds;
    all += seconds;
  }
  return least / static_cast<double>(calls);
}

/// Seconds per contact set of `force`, which computes the force of a copy of the set that `load` has made; the time of
/// copying is subtracted.
template <class Load, class Force>
double seconds_per_force(const std::vector<ContactBuffer>& sets, int repetitions, Load load, Force force) {
  const double copying = seconds_per_call(sets.size(), repetitions, [&] {
    for (const ContactBuffer& set : sets) load(set);
  });
  const double seconds = seconds_per_call(sets.size(), repetitions, [&] {
    for (const ContactBuffer& set : sets) {
      load(set);
      force();
    }
  });
  return std::max(0.0, seconds - copying);
}

/// Prepares a scenario in which a hand presses a drill into the block's hole to be measured: its device becomes an
/// ideal one with the same force limit, so that the device adds no dynamics of its own; it ends after one period of the
/// tilt and records nothing. Throws InputError when the scenario has no block_with_hole, or a tool whose ideal
/// trajectory is not known.
Scenario drill_in_hole(Scenario scenario);

/// The colliding points of every `stride`-th row of a scenario, with depth and gradient, before any point stage; rows
/// without contact are left out.
std::vector<ContactBuffer> contact_sets(Scenario scenario, std::uint64_t stride);

/// The contacts of every `stride`-th row of a scenario after its point stages, without rows that have none.
std::vector<ContactBuffer> rendered_contact_sets(const Scenario& scenario, std::uint64_t stride);

/// The size of the largest set.
std::size_t largest_size(const std::vector<ContactBuffer>& sets);

}  // namespace hapbench
