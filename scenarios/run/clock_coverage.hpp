#pragma once

#include <optional>

#include "results/summary/summary.hpp"
#include "scenarios/scene/recordings.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/contact/trace_source.hpp"

/// Compares the times of a recording with the times of the run that plays it.
namespace hapbench {

/// Returns a warning if the times of the stroke and of the run do not overlap, if the stroke starts late or ends early,
/// or if the clock of the stroke probably has another unit. The warning names the unit's factor if another factor fits.
/// Cost: O(log n) for n samples.
std::optional<Warning> stroke_clock_warning(const Stroke& stroke, const TimeFields& time);

/// Returns a warning if steps that look for contacts find no time of the trace because the trace ends early, is slower
/// than the run, or has a clock in another unit; or if it is faster, so that the run skips times. Steps before the
/// first contact are not reported, because a tool usually starts above the surface. `every`: contacts are looked for
/// in steps 0, every, 2 every, … Cost: O(number of times within the run).
std::optional<Warning> trace_clock_warning(const ContactTrace& trace, const TimeFields& time, std::int64_t every);

}  // namespace hapbench
