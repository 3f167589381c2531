#pragma once

#include <optional>

#include "results/summary/summary.hpp"
#include "scenarios/scene/recordings.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/trace_source.hpp"

/// Compares the times of a recording (a stroke or a trace of contacts) with the times of the run that plays it.
namespace hapbench {

/// Returns a warning in three cases: the times of the stroke and of the run do not overlap, the stroke starts late or
/// ends early, or the clock of the stroke probably does not count in seconds. If another unit fits, such as
/// milliseconds, the warning names the factor that converts the times to seconds. Cost: O(log n) for n samples.
std::optional<Warning> stroke_clock_warning(const Stroke& stroke, const TimeFields& time);

/// Compares the times of the trace with the steps in which the run searches contacts: steps 0, every, 2 every, …
/// Returns a warning in two cases. First, the trace has no time within half a time step of some of these steps, because
/// the trace ends early, has longer intervals between its times than the run, does not count in seconds, or does not
/// start with the run, or has another rate than the run. Second, the trace has shorter intervals between its times than
/// the run, so that the run skips some times of the trace. Returns no warning for missing times before the first
/// contact, because a tool usually starts above the surface. Cost: O(number of steps and of times).
std::optional<Warning> trace_clock_warning(const ContactTrace& trace, const TimeFields& time, std::int64_t every);

}  // namespace hapbench
