#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

namespace hapbench {

/// Deadlines of a haptic loop [s]: the thesis's simulations step at 2 kHz, its device at 2048 Hz.
inline constexpr std::array<double, 2> kStepDeadlines = {0.5e-3, 1.0 / 2048.0};

/// Distribution of the step times of a run. The mean is not enough: a user feels a single late step of a haptic loop.
struct StepLatency {
  /// Steps from `from` to below `to` [ns].
  struct Bin {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    std::uint64_t steps = 0;
  };

  static constexpr std::size_t kSpans = 240;

  std::uint64_t steps = 0;
  /// Percentiles by nearest rank: the shortest time that at least so many percent of the steps do not exceed [ns].
  std::uint64_t p50 = 0, p95 = 0, p99 = 0, p99_9 = 0;
  std::uint64_t max = 0;                                         ///< [ns]
  std::array<std::uint64_t, kStepDeadlines.size()> misses = {};  ///< steps longer than each deadline
  /// Bins between powers of two, from the first to the last that is not empty.
  std::vector<Bin> histogram;
  /// Medians of up to kSpans spans of the run, of equal numbers of steps, in their order [ns]: the load of the loop
  /// over time.
  std::vector<std::uint64_t> over_time;
  std::uint64_t overhead = 0;  ///< of the clock, subtracted from each step [ns]
};

/// Computes the distribution of step times [ns] and stores `overhead` with it. All values are zero without steps.
/// O(n log n).
StepLatency step_latency(std::span<const std::uint64_t> nanoseconds, std::uint64_t overhead);

/// For timing.json, in seconds; percentiles and maximum are null without steps.
nlohmann::ordered_json step_latency_json(const StepLatency& latency);

}  // namespace hapbench
