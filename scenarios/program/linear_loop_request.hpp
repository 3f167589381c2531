#pragma once

#include "scenarios/program/program_arguments.hpp"
#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// Internal argument of "hapbench audit", by which its Python package computes the linear loop of a device at a wall.
inline constexpr const char* kLinearLoop = "--linear-loop";

/// Prints the linear loop of an impedance device at a two-sided wall as JSON: the linear limit of K without a hand and
/// over typical_hands(), the frequency of the oscillation at this limit, and frequency and growth at the given K.
/// `given`: kLinearLoop, the device (a preset or FILE.json), the sampling period [s], K [N/m], the damping B of the
/// wall [N s/m], and a delay [s] that is added to the delay of the device. Returns the exit status. Throws InputError,
/// also for a device that the linear theory does not cover.
int print_linear_loop(const ProgramArguments& given, ProgramContext& context);

}  // namespace hapbench
