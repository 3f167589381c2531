#pragma once

namespace hapbench {

/// Exit status of the program.
enum ExitStatus : int {
  kSuccess = 0,
  kInternalFault = 1,
  kBadInput = 2,
  kUnexpectedOutcome = 3,  ///< a simulation diverged, or missed another expectation of its scenario
  kStopped = 128,          ///< plus the number of the signal, like shells: 130 for Ctrl-C, 143 for SIGTERM
};

}  // namespace hapbench
