#pragma once

#include "scenarios/program/program_arguments.hpp"
#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// Internal argument of "hapbench audit". With it, the Python package of this command requests the linear loop of a
/// device at a wall.
inline constexpr const char* kLinearLoop = "--linear-loop";

/// Prints the linear loop of an impedance device at a two-sided wall as JSON: the linear limit of K without a hand, the
/// smallest linear limit of K over typical_hands(), the published limit, and the parameters of the device. Also prints
/// frequency and growth of the slowest-decaying oscillation, at the given K and at the linear limit. An infinite limit
/// is null.
/// `given`: kLinearLoop, the device (a preset or FILE.json), the sampling period [s], K [N/m], the damping B of the
/// wall [N s/m], and a delay [s] that is added to the delay of the device. Returns the exit status. Throws InputError
/// for an invalid argument and for a device that the linear theory does not cover.
int print_linear_loop(const ProgramArguments& given, ProgramContext& context);

}  // namespace hapbench
