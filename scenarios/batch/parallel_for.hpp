#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

/// Loops over runs on several threads.
namespace hapbench {

/// Callback that stores the result of a finished run; called by one thread at a time. May be empty.
using Delivery = std::function<void()>;

/// Returns the next run to start, or none when no further run is to start; called by one thread at a time.
using NextRun = std::function<std::optional<std::size_t>()>;

/// Calls `work` on `jobs` threads for the runs that `next` returns, and then the deliveries that `work` returns, in the
/// order in which runs finish; of `next` and the deliveries one at a time. Runs start in the order of `next`, and at
/// most `jobs` runs are started and not yet delivered. Results depend on `jobs` only if `work` or the deliveries depend
/// on their order. An exception from any of them stops the loop and is rethrown. Overhead: some microseconds for each
/// run, some tens for each thread.
void parallel_for(const NextRun& next, std::size_t jobs, const std::function<Delivery(std::size_t run)>& work);
/// Number of threads that this process may use at once.
std::size_t available_threads();

/// How for_each_job processes a list of jobs.
struct JobOptions {
  unsigned threads = 1;  ///< jobs at once; at least 1
  std::string label;     ///< text before the progress bar; empty for no bar
};

/// Calls job(0) … job(count - 1), each once, in any order and on several threads. Jobs must be independent: each writes
/// to its own place, so that the result does not depend on the number of threads. After an exception no further job
/// starts, and the exception of the lowest job is rethrown. A signal (stop_signal.hpp) ends the loop the same way.
void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job);

}  // namespace hapbench
