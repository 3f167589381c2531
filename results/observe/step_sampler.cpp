#include "results/observe/step_sampler.hpp"

#include <algorithm>
#include <limits>

namespace hapbench {
namespace {

/// Every so many steps at most: what is seen must not be what looking costs.
constexpr std::uint64_t kLeastApart = 8;
constexpr std::size_t kEmptySamples = 101;  // to learn what the clock costs

}  // namespace

StepSampler::StepSampler(std::uint64_t steps) : every_(std::max(kLeastApart, steps / kMostSamples + 1)) {
  samples_.reserve(std::max<std::size_t>(kEmptySamples, static_cast<std::size_t>(steps / every_) + 1));
  for (std::size_t i = 0; i < kEmptySamples; ++i) {
    start(0);
    stop();
  }
  const auto median = samples_.begin() + kEmptySamples / 2;
  std::nth_element(samples_.begin(), median, samples_.end());
  overhead_ = *median;
  samples_.clear();
}

void StepSampler::start(std::uint64_t step) noexcept {
  if (step % every_ != 0) return;
  runs_ = true;
  start_ = Clock::now();
}

void StepSampler::stop() noexcept {
  if (!runs_) return;
  runs_ = false;
  const auto time = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start_).count() - overhead_;
  samples_.push_back(
      static_cast<std::uint32_t>(std::clamp<std::int64_t>(time, 0, std::numeric_limits<std::uint32_t>::max())));
}

}  // namespace hapbench
