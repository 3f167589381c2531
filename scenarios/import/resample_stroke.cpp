#include "scenarios/import/resample_stroke.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/input/input_error.hpp"

namespace hapbench {

StrokeClock clock_of(const StrokeSamples& stroke) {
  StrokeClock clock;
  clock.first = stroke.time.front();
  clock.duration = stroke.time.back() - stroke.time.front();
  std::vector<double> intervals;
  for (std::size_t i = 1; i < stroke.size(); ++i) intervals.push_back(stroke.time[i] - stroke.time[i - 1]);
  const double even = clock.duration / static_cast<double>(intervals.size());
  clock.is_regular = true;
  for (std::size_t i = 0; i < stroke.size(); ++i) {
    const double off = stroke.time[i] - clock.first - static_cast<double>(i) * even;
    clock.is_regular = clock.is_regular && std::abs(off) <= 1e-3 * even;
  }
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  clock.interval_min = *std::min_element(intervals.begin(), intervals.end());
  clock.interval_max = *std::max_element(intervals.begin(), intervals.end());
  std::nth_element(intervals.begin(), middle, intervals.end());
  clock.interval_median = *middle;
  return clock;
}

std::vector<StrokeGap> gaps_in(const StrokeSamples& stroke, const StrokeClock& clock) {
  constexpr double kLongIntervals = 10.0;
  std::vector<StrokeGap> gaps;
  for (std::size_t i = 1; i < stroke.size(); ++i) {
    const double interval = stroke.time[i] - stroke.time[i - 1];
    if (interval >= kLongIntervals * clock.interval_median) gaps.push_back({i - 1, interval});
  }
  return gaps;
}

StrokeSamples resampled(const StrokeSamples& stroke, double rate) {
  constexpr double kMost = 1e7;
  const double duration = stroke.time.back() - stroke.time.front();
  if (!(rate > 0.0 && std::isfinite(rate) && duration * rate < kMost))
    throw InputError(
        fmt::format("rate: got {:g} Hz for {:.6g} s; allowed: above 0, and up to {:g} samples", rate, duration, kMost));
  StrokeSamples out;
  out.has_roll = stroke.has_roll;
  // A last sample that is on the grid but for rounding belongs to it.
  const auto steps = static_cast<std::size_t>(std::floor(duration * rate * (1.0 + 1e-12)));
  std::size_t next = 1;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double time = static_cast<double>(k) / rate, recorded = stroke.time.front() + time;
    while (next + 1 < stroke.size() && stroke.time[next] <= recorded) ++next;
    const std::size_t last = next - 1;
    const double part = std::clamp((recorded - stroke.time[last]) / (stroke.time[next] - stroke.time[last]), 0.0, 1.0);
    out.time.push_back(time);
    out.position.push_back(stroke.position[last] + part * (stroke.position[next] - stroke.position[last]));
    out.turn.push_back(stroke.turn[last].slerp(part, stroke.turn[next]).normalized());
    if (!stroke.force.empty())
      out.force.push_back(stroke.force[last] + part * (stroke.force[next] - stroke.force[last]));
  }
  return out;
}

}  // namespace hapbench
