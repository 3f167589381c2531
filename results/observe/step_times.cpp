#include "results/observe/step_times.hpp"

#include <algorithm>

namespace hapbench {
namespace {

/// Steps that do nothing, timed to learn what timing costs: enough that the first ones, with cold caches, do not
/// matter.
constexpr std::size_t kEmptySteps = 501;

}  // namespace

// Filled with zeros, so that the pages are there before the first step.
StepTimes::StepTimes(std::size_t capacity) : times_(std::max(capacity, kEmptySteps)) {
  start();
  for (std::size_t i = 0; i < kEmptySteps; ++i) lap();
  const auto median = times_.begin() + kEmptySteps / 2;
  std::nth_element(times_.begin(), median, times_.begin() + kEmptySteps);
  overhead_ = *median;
  size_ = 0;
}

void StepTimes::lap() noexcept {
  const Clock::time_point now = Clock::now();
  const std::int64_t ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_).count() - static_cast<std::int64_t>(overhead_);
  last_ = now;
  times_[size_++] = static_cast<std::uint64_t>(std::max<std::int64_t>(ns, 0));
}

}  // namespace hapbench
