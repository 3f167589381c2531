#include "results/observe/step_times.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace hapbench {
namespace {

/// Number of empty steps timed to measure the time of a clock reading. The number is large enough that the first steps,
/// with cold caches, do not affect the median.
constexpr std::size_t kEmptySteps = 501;

using Times = std::vector<std::uint64_t>;

/// Returns a percentile by nearest rank. `per_mille` is the percentile in tenths of a percent, an integer, so that the
/// rank is exact. Precondition: `sorted` is in ascending order and not empty.
std::uint64_t percentile(const Times& sorted, std::size_t per_mille) {
  const std::size_t rank = (sorted.size() * per_mille + 999) / 1000;
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

/// Returns the histogram of the times. Bin k counts the times with k binary digits: 0 ns (k = 0), 1 ns, 2 to 3 ns, 4 to
/// 7 ns, and so on up to k = 63.
std::vector<StepLatency::Bin> histogram(const Times& sorted) {
  std::array<std::uint64_t, std::numeric_limits<std::int64_t>::digits + 1> count = {};
  for (const std::uint64_t time : sorted) ++count[static_cast<std::size_t>(std::bit_width(time))];
  std::vector<StepLatency::Bin> bins;
  const auto last = static_cast<std::size_t>(std::bit_width(sorted.back()));
  for (auto k = static_cast<std::size_t>(std::bit_width(sorted.front())); k <= last; ++k) {
    const std::uint64_t to = std::uint64_t{1} << k;
    bins.push_back({to / 2, to, count[k]});
  }
  return bins;
}

/// Divides the steps into up to kSpans consecutive intervals, and returns the median time of each interval [ns].
Times medians_over_time(std::span<const std::uint64_t> times) {
  const std::size_t spans = std::min(times.size(), StepLatency::kSpans);
  Times medians;
  for (std::size_t i = 0; i < spans; ++i) {
    const std::size_t first = i * times.size() / spans, last = (i + 1) * times.size() / spans;
    const std::span<const std::uint64_t> part = times.subspan(first, last - first);
    Times sorted(part.begin(), part.end());
    std::sort(sorted.begin(), sorted.end());
    medians.push_back(percentile(sorted, 500));
  }
  return medians;
}

}  // namespace

// Filling the buffer with zeros makes the operating system allocate its pages before the first step.
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

void StepSampler::on_step(const StepRecord& record) noexcept {
  observing_ = !observing_;
  if (observing_) {
    if (std::exchange(runs_, false)) times_.lap();
  } else if (record.step % every_ == 0) {
    runs_ = true;
    times_.start();
  }
}

StepLatency step_latency(std::span<const std::uint64_t> nanoseconds, std::uint64_t overhead) {
  StepLatency latency;
  latency.overhead = overhead;
  latency.steps = nanoseconds.size();
  if (nanoseconds.empty()) return latency;
  Times sorted(nanoseconds.begin(), nanoseconds.end());
  std::sort(sorted.begin(), sorted.end());
  latency.p50 = percentile(sorted, 500);
  latency.p95 = percentile(sorted, 950);
  latency.p99 = percentile(sorted, 990);
  latency.p99_9 = percentile(sorted, 999);
  latency.max = sorted.back();
  for (std::size_t i = 0; i < kStepDeadlines.size(); ++i) {
    const auto is_late = [i](std::uint64_t time) { return static_cast<double>(time) > kStepDeadlines[i] * 1e9; };
    latency.misses[i] = static_cast<std::uint64_t>(std::ranges::count_if(sorted, is_late));
  }
  latency.histogram = histogram(sorted);
  latency.over_time = medians_over_time(nanoseconds);
  return latency;
}

}  // namespace hapbench
