#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Measures the wall time of every step of a run. The buffer is allocated in the constructor, 8 bytes a step. A
/// single clock reading ends one step and starts the next.
class StepTimes {
 public:
  /// `capacity`: largest number of steps. Also measures the time of a clock reading, which takes about 20 µs.
  explicit StepTimes(std::size_t capacity);

  using Clock = std::chrono::steady_clock;

  /// Starts a step. Call it before the first step and after a pause. `since`: time at which the step began.
  void start(Clock::time_point since = Clock::now()) noexcept { last_ = since; }
  /// Ends a step and starts the next step. Precondition: fewer than `capacity` steps so far.
  void lap() noexcept;

  /// Returns the wall time of each step [ns], in the order of the steps, minus the time of a clock reading.
  std::span<const std::uint64_t> nanoseconds() const { return {times_.data(), size_}; }
  /// Returns the time of a clock reading [ns]: the median time of empty steps.
  std::uint64_t overhead() const { return overhead_; }

 private:
  std::vector<std::uint64_t> times_;
  std::size_t size_ = 0;
  std::uint64_t overhead_ = 0;
  Clock::time_point last_;
};

/// Samples the time of a step, excluding its observers: from after the last observer of one step to before the first
/// observer of the next step. This covers the integrator's part of one step, and hand, contact search, force law and
/// device of the next step. Attach the sampler twice, before and after all other observers. Samples every step of a
/// short run, and at most kMaxSamples evenly spread steps of a long run, which is enough for a 99th percentile. A
/// sample takes two clock readings. Allocates only in the constructor.
class StepSampler final : public Observer {
 public:
  static constexpr std::uint64_t kMaxSamples = 1 << 13;

  /// `steps`: largest number of steps of the run.
  explicit StepSampler(std::uint64_t steps)
      : every_(steps / kMaxSamples + 1), times_(static_cast<std::size_t>(steps / every_) + 1) {}
  void on_step(const StepRecord& record) noexcept override;

  /// Returns the sampled times [ns], in the order of the steps, minus the time of a clock reading.
  std::span<const std::uint64_t> nanoseconds() const { return times_.nanoseconds(); }

 private:
  std::uint64_t every_;
  StepTimes times_;
  bool runs_ = false;       ///< true between the start and the end of a sample
  bool observing_ = false;  ///< true after the first of the two calls of on_step in a step
};

/// Deadlines of a haptic loop [s]: the thesis's simulations run at 2 kHz, its device at 2048 Hz.
inline constexpr std::array<double, 2> kStepDeadlines = {0.5e-3, 1.0 / 2048.0};

/// Distribution of the step times of a run. The mean is not enough, because a user feels a single late step.
struct StepLatency {
  /// Histogram bin: number of steps whose time is at least `from` and less than `to` [ns].
  struct Bin {
    std::uint64_t from = 0;
    std::uint64_t to = 0;
    std::uint64_t steps = 0;
  };

  static constexpr std::size_t kSpans = 240;  ///< largest number of entries in over_time

  std::uint64_t steps = 0;
  /// Percentiles of the step times by nearest rank: the shortest time t [ns] for which at least this percentage of the
  /// steps takes at most t.
  std::uint64_t p50 = 0, p95 = 0, p99 = 0, p99_9 = 0;
  std::uint64_t max = 0;                                         ///< longest time [ns]
  std::array<std::uint64_t, kStepDeadlines.size()> misses = {};  ///< number of steps longer than each deadline
  /// Bins between powers of two, from the first to the last bin that is not empty.
  std::vector<Bin> histogram;
  /// Step times over the run: the run is divided into up to kSpans intervals with (nearly) equal numbers of steps, and
  /// each entry is the median step time of an interval [ns].
  std::vector<std::uint64_t> over_time;
  std::uint64_t overhead = 0;  ///< time of a clock reading, already subtracted from each step [ns]
};

/// Returns the distribution of step times [ns]; `overhead` is stored unchanged. All values are zero without steps.
/// Cost: O(n log n).
StepLatency step_latency(std::span<const std::uint64_t> nanoseconds, std::uint64_t overhead);

}  // namespace hapbench
