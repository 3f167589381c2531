#include "scenarios/run/clock_coverage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scenarios/scene/named_files.hpp"

namespace hapbench {
namespace {

/// A unit of time in which the clock of a recording may count instead of seconds. per_second: number of units in a
/// second.
struct ClockUnit {
  double per_second;
  const char* advice;
};
constexpr ClockUnit kClockUnits[] = {
    {1e3, "its clock seems to be in milliseconds: divide the times by 10^3"},
    {1e6, "its clock seems to be in microseconds: divide the times by 10^6"},
    {1e9, "its clock seems to be in nanoseconds: divide the times by 10^9"},
    {1e-3, "its clock seems to be too slow by 10^3: multiply the times by 10^3"},
    {1e-6, "its clock seems to be too slow by 10^6: multiply the times by 10^6"},
    {1e-9, "its clock seems to be too slow by 10^9: multiply the times by 10^9"},
};
/// If the sample interval and the time step differ by more than this factor, the unit is probably wrong.
constexpr double kUnlikelyRatio = 100.0;

/// Time step and end of a run [s], and its number of steps.
struct RunTimes {
  explicit RunTimes(const TimeFields& time)
      : step(time.step), steps(static_cast<double>(time.steps)), end(time.step * static_cast<double>(time.steps - 1)) {}

  double step, steps, end;
};

/// Returns the facts about both clocks, such as "the stroke has 201 samples from 0 to 0.4 s, one per 2 ms (500 Hz); the
/// run has …".
std::string facts(const std::string& recording, double first, double last, std::size_t count, const RunTimes& run) {
  const double interval = count > 1 ? (last - first) / static_cast<double>(count - 1) : 0.0;
  const std::string rate =
      interval > 0.0 ? fmt::format(", one per {:.4g} ms ({:.4g} Hz)", 1e3 * interval, 1.0 / interval) : "";
  return fmt::format("the {} from {:.6g} to {:.6g} s{}; the run has {} steps from 0 to {:.6g} s, one per {:.4g} ms",
                     recording, first, last, rate, run.steps, run.end, 1e3 * run.step);
}

// ---- Strokes

using Samples = std::span<const RecordedMotion::Sample>;

double interval_of(Samples samples) {
  return (samples.back().time - samples.front().time) / static_cast<double>(samples.size() - 1);
}

bool is_unlikely_interval(double interval, const RunTimes& run) {
  return interval > kUnlikelyRatio * run.step || interval * kUnlikelyRatio < run.step;
}

/// Returns the unit of the stroke's clock with which the stroke lasts about as long as the run, or has a usual sample
/// rate. Returns null if there is no such unit.
const ClockUnit* unit_of_stroke(Samples samples, const RunTimes& run) {
  const double interval = interval_of(samples), span = samples.back().time - samples.front().time;
  const auto fits = [&](const ClockUnit& unit, double factor) {
    const double ratio = span / unit.per_second / run.end;
    return ratio > 1.0 / factor && ratio < factor;
  };
  for (const double factor : {1.1, 3.0})
    for (const ClockUnit& unit : kClockUnits)
      if (fits(unit, factor)) return &unit;
  // The duration of the run may have been set to the duration of the stroke, so it does not show the unit. Return the
  // first unit in which the recording has a usual sample rate.
  constexpr double kFastest = 2e-4, kSlowest = 0.05;  // range of usual sample intervals [s]
  constexpr std::size_t kMinSamples = 20;             // fewer samples may be waypoints
  for (const ClockUnit& unit : kClockUnits) {
    const double scaled = interval / unit.per_second;
    if (samples.size() >= kMinSamples && scaled >= kFastest && scaled <= kSlowest) return &unit;
  }
  return nullptr;
}

/// Returns true if so few samples of the stroke lie within the run that the clock of the stroke probably does not count
/// in seconds.
bool sees_few_samples(Samples samples, const RunTimes& run) {
  constexpr std::ptrdiff_t kFew = 3;
  constexpr std::size_t kMinSamples = 10;
  const auto end = std::ranges::upper_bound(samples, run.end, {}, &RecordedMotion::Sample::time);
  return samples.size() >= kMinSamples && end - samples.begin() <= kFew && run.steps > 10.0;
}

// ---- Traces

/// Counts that show how many contact queries of a run a trace covers.
struct TraceCoverage {
  std::uint64_t queries = 0;  ///< number of steps in which the run searches contacts
  std::uint64_t covered = 0;  ///< number of these steps for which the trace has a time within kTraceWindow
  /// Number of these steps that are not covered although they lie between two successive times of the trace that are
  /// less than 1.9 query intervals apart: the trace goes on, but its clock does not meet the steps.
  std::uint64_t between = 0;
};

/// Returns the TraceCoverage of a trace whose clock counts `per_second` units in a second: divides the times of the
/// trace by `per_second` first. The run searches contacts in the steps 0, every, 2 every, …
TraceCoverage coverage_of(const ContactTrace& trace, const RunTimes& run, std::int64_t every, double per_second) {
  TraceCoverage coverage;
  coverage.queries = static_cast<std::uint64_t>((run.steps - 1.0) / static_cast<double>(every)) + 1;
  const double window = kTraceWindow * run.step, query = run.step * static_cast<double>(every);
  const auto& times = trace.times;
  const auto time_of = [&](std::size_t i) { return times[i].time / per_second; };
  std::size_t after = 0;  // index of the first time of the trace that is not before the query
  for (std::uint64_t k = 0; k < coverage.queries; ++k) {
    const double now = static_cast<double>(k) * query;
    while (after < times.size() && time_of(after) < now) ++after;
    const bool has_before = after > 0, has_after = after < times.size();
    const bool is_covered =
        (has_before && now - time_of(after - 1) <= window) || (has_after && time_of(after) - now <= window);
    coverage.covered += is_covered;
    coverage.between += !is_covered && has_before && has_after && time_of(after) - time_of(after - 1) < 1.9 * query;
  }
  return coverage;
}

/// Returns the median of the first 1000 intervals between the times of the trace [s]; 0 for fewer than two times.
double median_interval(const ContactTrace& trace) {
  constexpr std::size_t kMaxIntervals = 1000;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < std::min(trace.times.size(), kMaxIntervals + 1); ++i)
    intervals.push_back(trace.times[i].time - trace.times[i - 1].time);
  if (intervals.empty()) return 0.0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// Returns the unit of the trace's clock with which the trace covers at least a tenth of all contact queries, and at
/// least five times as many queries as with a clock in seconds (`coverage`). Returns null if there is no such unit.
const ClockUnit* unit_of_trace(const ContactTrace& trace, const RunTimes& run, std::int64_t every,
                               const TraceCoverage& coverage) {
  for (const ClockUnit& unit : kClockUnits) {
    const TraceCoverage scaled = coverage_of(trace, run, every, unit.per_second);
    if (scaled.covered >= 5 * std::max<std::uint64_t>(coverage.covered, 1) && 10 * scaled.covered >= scaled.queries)
      return &unit;
  }
  return nullptr;
}

/// Returns the unit of time in which `interval`, the interval between the times of the trace, agrees with `query`, the
/// interval between the contact queries [s], within the factor kFactor. Returns null if they agree with a trace in
/// seconds, or if they agree in no unit. Used for a clock that does not begin at 0.
const ClockUnit* unit_of_interval(double interval, double query) {
  constexpr double kFactor = 10.0;  // largest ratio of the two intervals that counts as agreement
  const auto fits = [&](double per_second) {
    const double ratio = interval / per_second / query;
    return ratio > 1.0 / kFactor && ratio < kFactor;
  };
  const auto* unit = std::ranges::find_if(kClockUnits, fits, &ClockUnit::per_second);
  return interval <= 0.0 || fits(1.0) || unit == std::end(kClockUnits) ? nullptr : unit;
}

/// Returns a text that describes why steps of the run find no contacts in the trace; empty if the tool may just have
/// been out of contact. `interval`: between the times of the trace [s]. `query`: between the steps that look for
/// contacts [s]. Precondition: some of these steps are not covered.
std::string missing_steps_problem(const ContactTrace& trace, const RunTimes& run, std::int64_t every, double interval,
                                  const TraceCoverage& coverage) {
  const double first = trace.times.front().time, last = trace.times.back().time;
  const double query = run.step * static_cast<double>(every);
  if (const ClockUnit* unit = unit_of_trace(trace, run, every, coverage)) return unit->advice;
  if (coverage.covered == 0 && first > run.end) {
    const ClockUnit* unit = unit_of_interval(interval, query);
    return fmt::format(
        "subtract the time at which the recording began (the first contact may be later) from the times "
        "of the trace{}{}",
        unit != nullptr ? "; " : "", unit != nullptr ? unit->advice : "");
  }
  if (coverage.covered == 0) return "no step has a time of the trace: is time_s in seconds from the start of the run?";
  if (interval > 1.5 * query)
    return fmt::format(
        "the trace is slower than the run: rendering.contacts.every={:.0f} plays the contacts of a slower loop",
        std::max(2.0, std::round(interval / run.step)));
  if (coverage.between > 0)
    return fmt::format(
        "{} of them lie between two times of the trace and have no contact although the trace goes on: its clock "
        "does not have the run's step; time.step_s={:.4g} plays every time, or resample the trace",
        coverage.between, interval / static_cast<double>(every));
  if (last + 1.5 * std::max(query, interval) < run.end)
    return fmt::format("the trace ends before the run: if the tool is still in contact then, set time.steps={:.0f}",
                       std::floor(last / run.step + 0.5) + 1.0);
  return "";
}

/// Returns a text that describes the fault of the trace's clock; empty if the clock fits the run.
std::string trace_problem(const ContactTrace& trace, const RunTimes& run, std::int64_t every,
                          const TraceCoverage& coverage) {
  const double interval = median_interval(trace);
  if (coverage.covered < coverage.queries) {
    std::string problem = missing_steps_problem(trace, run, every, interval, coverage);
    if (!problem.empty()) return problem;
  }
  if (interval > 0.0 && interval < 0.75 * run.step)
    return fmt::format(
        "the trace is faster than the run, which skips the times between its steps: time.step_s={:.4g} plays all times",
        interval);
  return "";
}

}  // namespace

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the cases in the order of their priority.
std::optional<Warning> stroke_clock_warning(const Stroke& stroke, const TimeFields& time) {
  const RunTimes run(time);
  const Samples samples = stroke.motion.samples();
  const double start = samples.front().time, stop = samples.back().time;
  const auto warning = [](std::string text) {
    return Warning{"stroke_clock", std::string(kMotionFile), std::move(text)};
  };
  // Warn if stroke and run do not overlap in time.
  if (start > run.end || stop < 0.0) {
    const ClockUnit* unit = samples.size() > 1 ? unit_of_stroke(samples, run) : nullptr;
    return warning(
        fmt::format("the stroke's clock runs from {:.6g} to {:.6g} s and the run's from 0 to {:.6g} s: the tool "
                    "stays at the {} sample; let the stroke begin at 0 or adapt time{}{}",
                    start, stop, run.end, start > run.end ? "first" : "last", unit != nullptr ? "; " : "",
                    unit != nullptr ? unit->advice : ""));
  }
  if (samples.size() < 2)
    return run.steps < 2.0
               ? std::nullopt
               : std::optional(warning("the stroke has a single sample: the tool stands still in all steps"));
  const std::string both =
      facts(fmt::format("stroke has {} samples", samples.size()), start, stop, samples.size(), run);
  // Warn if another unit of time fits better, or if the sample interval is unlikely.
  constexpr double kMissing = 0.05;  // fraction of the run that may lie before the first or after the last sample
  const double interval = interval_of(samples);
  const bool is_unlikely = is_unlikely_interval(interval, run);
  const bool is_short = stop + 2.0 * interval < (1.0 - kMissing) * run.end;
  const bool is_late = start - 2.0 * interval > kMissing * run.end;
  const ClockUnit* unit =
      is_unlikely || is_short || sees_few_samples(samples, run) ? unit_of_stroke(samples, run) : nullptr;
  if (unit != nullptr && !(is_short && unit->per_second > 1.0))
    return warning(fmt::format("{}: {}", both, unit->advice));
  if (is_unlikely)
    return warning(fmt::format("{}: are the stroke's times in seconds, and is time.step_s right?", both));
  // Warn if the stroke does not cover the start or the end of the run.
  if (!is_short && !is_late) return std::nullopt;
  constexpr double kRounding = 1e-6;  // tolerance as a fraction of a step
  const double last_step = std::floor(stop / run.step + kRounding);
  const double covered = std::min(last_step + 1.0, run.steps) - std::max(0.0, std::ceil(start / run.step));
  std::string text = fmt::format("{}: the stroke covers {:.3g} % of the steps", both, 100.0 * covered / run.steps);
  if (is_late)
    text += fmt::format(
        "; the tool stays at the first sample for {:.4g} s: to begin with the stroke, subtract its first "
        "time",
        start);
  if (is_short)
    text += fmt::format("{} the tool stays at the last sample after it; time.steps={:.0f} ends the run with the stroke",
                        is_late ? ";" : ", and", last_step + 1.0);
  return warning(std::move(text));
}

std::optional<Warning> trace_clock_warning(const ContactTrace& trace, const TimeFields& time, std::int64_t every) {
  const RunTimes run(time);
  const auto warning = [](std::string text) {
    return Warning{"trace_clock", std::string(kContactFile), std::move(text)};
  };
  if (trace.times.empty()) return warning("the trace has no rows: no step has a contact");
  const TraceCoverage coverage = coverage_of(trace, run, every, 1.0);
  const std::string problem = trace_problem(trace, run, every, coverage);
  if (problem.empty()) return std::nullopt;
  const std::size_t count = trace.times.size();
  return warning(fmt::format(
      "{}: {} of the {} steps that look for contacts have no time of the trace within half a step; {}",
      facts(fmt::format("trace has {} times", count), trace.times.front().time, trace.times.back().time, count, run),
      coverage.queries - coverage.covered, coverage.queries, problem));
}

}  // namespace hapbench
