#pragma once

#include <csignal>

#include "sim/loop/simulation.hpp"

/// Handles Ctrl-C and SIGTERM. The handler only records the signal; loops check for it between steps and end by
/// an exception, so that destructors remove unfinished results.
///
/// The received signal is a single flag of the process and is not passed as an argument. A signal is sent to a
/// process and stops all of its work, including the calls of all Python threads. An argument would have to be passed
/// through all functions from the command to the loop over the time steps. A loop whose caller forgot the argument
/// could not be stopped.
namespace hapbench {

/// While an instance exists, the first SIGINT or SIGTERM is only recorded, so that work can end cleanly. If work has
/// not ended two seconds after this signal, the process is ended. A second signal more than 0.2 s after the first ends
/// the process immediately. Signals that were ignored before stay ignored. At most one instance may exist at a time.
/// Without an instance, only stop_work() can stop work.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Returns the signal received, or 0. May be called from any thread. Costs as much as reading a variable.
  static int received() noexcept;

 private:
  struct sigaction before_[2];
};

/// Thrown by work that a signal has stopped. Not derived from std::exception, so that code that turns failures
/// into results does not catch it.
struct Stopped {
  int signal = 0;
};

/// Stops all work of this process as if `signal` had been received. For a host with its own signal handling,
/// such as an interpreter. 0 clears the flag, so that new work can start. May be called from any thread.
void stop_work(int signal) noexcept;

/// Throws Stopped if a signal has been received.
void throw_if_stopped();

/// Number of steps between two checks for a signal. In the slowest simulations, these steps take a few milliseconds.
inline constexpr std::uint64_t kStepsPerStopCheck = 512;

/// Runs a simulation to its end by calls of `advance()`. Each call must do at most kStepsPerStopCheck steps and return
/// false once the run has ended. Throws Stopped if a signal has been received.
template <class Advance>
SimulationResult run_to_end(Simulation& simulation, Advance advance) {
  do {
    throw_if_stopped();
  } while (advance());
  throw_if_stopped();  // after a stop request, a Python law returns an invalid force, which ends the run
  return simulation.result();
}
/// Runs a simulation to its end with Simulation::advance(). Throws Stopped if a signal has been received.
/// Allocates nothing.
inline SimulationResult run_to_end(Simulation& simulation) {
  return run_to_end(simulation, [&simulation] { return simulation.advance(kStepsPerStopCheck); });
}

}  // namespace hapbench
