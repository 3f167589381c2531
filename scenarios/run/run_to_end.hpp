#pragma once

#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Steps from one question whether to stop to the next: some milliseconds of the slowest there are.
inline constexpr std::uint64_t kAskEvery = 512;

/// Steps a simulation to its end. Asks every kAskEvery steps whether a signal wants the program to stop, and then
/// throws Stopped (stop_signal.hpp). Allocates nothing.
SimulationResult run_to_end(Simulation& simulation);

}  // namespace hapbench
