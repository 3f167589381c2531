#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "scenarios/run/progress_bar.hpp"

/// A pool of threads that runs a list of jobs in order, with a progress bar.
namespace hapbench {

/// Number of threads that this process may use at once.
std::size_t available_threads();

/// How for_each_job processes a list of jobs.
struct JobOptions {
  unsigned threads = 1;                        ///< jobs at once; at least 1
  std::string label;                           ///< text before the progress bar; empty for no bar
  const ProgressListener* listener = nullptr;  ///< hears of the bar in place of the terminal; null: it is drawn
};

/// Calls job(0) … job(count - 1), each once, on several threads. Jobs begin in this order, and at most `threads` of
/// them run at once. Each job writes to its own place, so that results do not depend on the number of threads. After an
/// exception no further job starts, and the exception of the lowest job is thrown again. A signal (stop_signal.hpp)
/// ends the loop in the same way. Throws std::runtime_error before any job begins if the threads cannot be started.
/// Overhead: some microseconds for each job, some tens for each thread.
void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job);

}  // namespace hapbench
