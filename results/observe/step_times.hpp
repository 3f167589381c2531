#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hapbench {

/// The wall time of every step of a run, in a buffer that is allocated beforehand. One reading of the clock ends a step
/// and starts the next, so that a step costs one reading and one store more than without. 8 bytes a step.
class StepTimes {
 public:
  /// Room for `capacity` steps. Measures what reading the clock costs, which takes about 20 µs.
  explicit StepTimes(std::size_t capacity);

  using Clock = std::chrono::steady_clock;

  /// Starts the clock; call it before the first step and after a pause. The step may have begun earlier.
  void start(Clock::time_point since = Clock::now()) noexcept { last_ = since; }
  /// Ends a step. Precondition: fewer than `capacity` steps so far.
  void lap() noexcept;

  /// Each step in their order [ns], the clock's own share subtracted.
  std::span<const std::uint64_t> nanoseconds() const { return {times_.data(), size_}; }
  /// The clock's own share: the median over steps that do nothing [ns].
  std::uint64_t overhead() const { return overhead_; }

 private:
  std::vector<std::uint64_t> times_;
  std::size_t size_ = 0;
  std::uint64_t overhead_ = 0;
  Clock::time_point last_;
};

}  // namespace hapbench
