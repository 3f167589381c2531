#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/loop/simulation.hpp"

namespace hapbench {

/// The wall time of every step of a run, in a buffer that is allocated beforehand, 8 bytes a step. One reading of the
/// clock ends a step and starts the next.
class StepTimes {
 public:
  /// Room for `capacity` steps. Measures what reading the clock costs, which takes about 20 µs.
  explicit StepTimes(std::size_t capacity);

  using Clock = std::chrono::steady_clock;

  /// Starts the clock; call it before the first step and after a pause. The step may have begun earlier.
  void start(Clock::time_point since = Clock::now()) noexcept { last_ = since; }
  /// Ends a step. Precondition: fewer than `capacity` steps so far.
  void lap() noexcept;

  /// Each step in their order [ns], the cost of reading the clock subtracted.
  std::span<const std::uint64_t> nanoseconds() const { return {times_.data(), size_}; }
  /// Cost of reading the clock: the median over steps that do nothing [ns].
  std::uint64_t overhead() const { return overhead_; }

 private:
  std::vector<std::uint64_t> times_;
  std::size_t size_ = 0;
  std::uint64_t overhead_ = 0;
  Clock::time_point last_;
};

/// Samples the time that steps take by themselves, from after the last observer of a row to before the first one of the
/// next: the integrator's part of one step and hand, search, law and device of the next. Attach it twice, before and
/// after all other observers. Samples every step of a short run and at most kMostSamples of a long one, evenly spread:
/// enough for a 99th percentile, two readings of the clock each. Allocates in the constructor only.
class StepSampler final : public Observer {
 public:
  static constexpr std::uint64_t kMostSamples = 1 << 13;

  /// `steps`: the most rows the run can have.
  explicit StepSampler(std::uint64_t steps)
      : every_(steps / kMostSamples + 1), times_(static_cast<std::size_t>(steps / every_) + 1) {}
  void on_step(const StepRecord& record) noexcept override;

  /// [ns], in their order, the cost of reading the clock subtracted.
  std::span<const std::uint64_t> nanoseconds() const { return times_.nanoseconds(); }

 private:
  std::uint64_t every_;
  StepTimes times_;
  bool runs_ = false;       ///< a sample has begun
  bool observing_ = false;  ///< the other observers see a row now
};

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
  /// Medians of up to kSpans consecutive spans of the run with equal numbers of steps [ns]: the load over time.
  std::vector<std::uint64_t> over_time;
  std::uint64_t overhead = 0;  ///< cost of reading the clock, already subtracted from each step [ns]
};

/// The distribution of step times [ns], with `overhead` beside it. All values are zero without steps. O(n log n).
StepLatency step_latency(std::span<const std::uint64_t> nanoseconds, std::uint64_t overhead);

}  // namespace hapbench
