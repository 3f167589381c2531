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

/// Prepares a scenario in which a hand presses a drill into the block's hole to be measured: its device becomes an
/// ideal one with the same force limit, so that the device adds no dynamics of its own; it ends after one period of the
/// tilt and records nothing.
Scenario drill_in_hole(Scenario scenario);

/// Before or after the scenario's point stages.
enum class Points { colliding, rendered };

/// A buffer of just the size of these contacts.
ContactBuffer copy_of(const ContactBuffer& contacts);

/// The points of every `stride`-th row of drill_in_hole(scenario), with depth and gradient; rows without contact are
/// left out.
std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride,
                                        Points points = Points::colliding);

/// The largest set, and its size.
ContactBuffer largest_of(const std::vector<ContactBuffer>& sets);
std::size_t largest_size(const std::vector<ContactBuffer>& sets);

}  // namespace hapbench
