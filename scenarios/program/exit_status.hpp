#pragma once

namespace hapbench {

/// Exit status of the program.
enum ExitStatus : int {
  kSuccess = 0,
  kInternalFault = 1,
  kBadInput = 2,
  kUnexpectedOutcome = 3,  ///< a simulation diverged, or missed another expectation of its scenario
  kStopped = 128,          ///< the number of the signal is added, as shells do: 130 for Ctrl-C, 143 for SIGTERM
};

}  // namespace hapbench
