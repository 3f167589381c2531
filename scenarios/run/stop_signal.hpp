#pragma once

#include <csignal>

#include "sim/loop/simulation.hpp"

/// Ctrl-C and SIGTERM: the program notes them, work asks for them between steps and ends itself by an exception, and
/// destructors remove what is unfinished.
///
/// The received signal is one flag of the process, which work reads without getting it passed. A signal is sent to a
/// process, and it stops all work in it: also the work of other threads of Python, where the first error ends all
/// computing calls. All callers of every loop would pass the same object on, from the command through searches, jobs
/// and claims to the step loop, and a loop whose caller forgot it could not be stopped.
namespace hapbench {

/// While it exists, the first SIGINT or SIGTERM is only recorded, so that work can end cleanly; another one more than
/// 0.2 s later terminates the process as usual, and so does the first if the work has not ended after two seconds.
/// Signals that were ignored stay ignored. At most one may exist at a time. Without it only stop_work sends a signal.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Returns the signal received, or 0. May be called from any thread; costs as much as reading a variable.
  static int received() noexcept;

 private:
  struct sigaction before_[2];
};

/// Thrown by work that a signal has ended. No std::exception: who makes a result of a failure must let it pass.
struct Stopped {
  int signal = 0;
};

/// Stops all work of this process as if the signal had been received: for a host with signals of its own, such as an
/// interpreter. 0 lets work begin again. From any thread.
void stop_work(int signal) noexcept;

/// Throws Stopped if a signal has been received.
void throw_if_stopped();

/// Steps from one question whether to stop to the next: some milliseconds of the slowest there are.
inline constexpr std::uint64_t kAskEvery = 512;

/// Steps a simulation to its end by calls of `advance()`, each of which takes kAskEvery steps at most and returns false
/// once the run has ended. Throws Stopped when a signal has come.
template <class Advance>
SimulationResult run_to_end(Simulation& simulation, Advance advance) {
  do {
    throw_if_stopped();
  } while (advance());
  throw_if_stopped();  // a force law may have ended the run by a force that is none, because the work is to stop
  return simulation.result();
}
/// The same by the simulation alone. Allocates nothing.
inline SimulationResult run_to_end(Simulation& simulation) {
  return run_to_end(simulation, [&simulation] { return simulation.advance(kAskEvery); });
}

}  // namespace hapbench
