#include "results/observe/step_latency.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <nlohmann/json.hpp>

namespace hapbench {
namespace {

using nlohmann::ordered_json;
using Times = std::vector<std::uint64_t>;

/// Nearest rank, in tenths of a percent so that the rank is computed exactly. Precondition: sorted and not empty.
std::uint64_t percentile(const Times& sorted, std::size_t per_mille) {
  const std::size_t rank = (sorted.size() * per_mille + 999) / 1000;
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

std::uint64_t longer_than(const Times& sorted, double seconds) {
  const auto ns = [](std::uint64_t time) { return static_cast<double>(time); };
  const auto first =
      std::partition_point(sorted.begin(), sorted.end(), [&](std::uint64_t time) { return ns(time) <= seconds * 1e9; });
  return static_cast<std::uint64_t>(sorted.end() - first);
}

/// Bin k holds the times of k binary digits: 0, 1, 2 … 3, 4 … 7 and so on. The clock counts up to 63 of them.
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

Times medians_over_time(std::span<const std::uint64_t> times) {
  const std::size_t spans = std::min(times.size(), StepLatency::kSpans);
  Times medians;
  for (std::size_t i = 0; i < spans; ++i) {
    const std::size_t first = i * times.size() / spans, last = (i + 1) * times.size() / spans;
    Times span(times.begin() + static_cast<std::ptrdiff_t>(first), times.begin() + static_cast<std::ptrdiff_t>(last));
    std::sort(span.begin(), span.end());
    medians.push_back(percentile(span, 500));
  }
  return medians;
}

double seconds(double nanoseconds) {
  return nanoseconds / 1e9;  // unlike times 1e-9, the double nearest to the decimal
}

}  // namespace

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
  for (std::size_t i = 0; i < kStepDeadlines.size(); ++i) latency.misses[i] = longer_than(sorted, kStepDeadlines[i]);
  latency.histogram = histogram(sorted);
  latency.over_time = medians_over_time(nanoseconds);
  return latency;
}

ordered_json step_latency_json(const StepLatency& latency) {
  const auto if_any = [&latency](std::uint64_t ns) {
    return latency.steps > 0 ? ordered_json(seconds(static_cast<double>(ns))) : ordered_json(nullptr);
  };
  ordered_json json = {{"steps", latency.steps},
                       {"clock_overhead_s", seconds(static_cast<double>(latency.overhead))},
                       {"p50_s", if_any(latency.p50)},
                       {"p95_s", if_any(latency.p95)},
                       {"p99_s", if_any(latency.p99)},
                       {"p99_9_s", if_any(latency.p99_9)},
                       {"max_s", if_any(latency.max)},
                       {"deadline_misses", ordered_json::array()},
                       {"histogram", ordered_json::array()},
                       {"over_time_s", ordered_json::array()}};
  for (std::size_t i = 0; i < kStepDeadlines.size(); ++i) {
    json["deadline_misses"].push_back({{"deadline_s", kStepDeadlines[i]}, {"steps", latency.misses[i]}});
  }
  for (const StepLatency::Bin& bin : latency.histogram) {
    json["histogram"].push_back({{"from_s", seconds(static_cast<double>(bin.from))},
                                 {"to_s", seconds(static_cast<double>(bin.to))},
                                 {"steps", bin.steps}});
  }
  for (const std::uint64_t median : latency.over_time) {
    json["over_time_s"].push_back(seconds(static_cast<double>(median)));
  }
  return json;
}

}  // namespace hapbench
