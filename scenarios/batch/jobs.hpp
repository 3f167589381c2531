#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "scenarios/run/progress_bar.hpp"

/// A pool of threads that runs a list of jobs in order, with a progress bar.
namespace hapbench {

/// Returns the number of threads that this process may use at the same time.
std::size_t available_threads();

/// Options of for_each_job().
struct JobOptions {
  unsigned threads = 1;  ///< number of jobs that run at the same time; at least 1
  std::string label;     ///< text before the progress bar; empty for no bar
  /// Listener that receives the progress, so that no bar is drawn; null: the bar is drawn.
  const ProgressListener* listener = nullptr;
};

/// Calls job(0) … job(count - 1), each once, on several threads. Jobs start in this order, and at most
/// `threads` of them run at the same time. Each job must write its result to a separate location, so that
/// results do not depend on the number of threads. After an exception, no further job starts, and the exception
/// of the job with the lowest number is rethrown. After a signal (stop_signal.hpp), no further job starts, and
/// Stopped is thrown. Throws std::runtime_error before any job starts if the threads cannot be started.
/// Overhead: a few microseconds for each job, some ten microseconds for each thread.
void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job);

}  // namespace hapbench
