#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace hapbench {

/// How a list of jobs is worked off.
struct JobOptions {
  unsigned threads = 1;  ///< at work at once; at least 1
  std::string label;     ///< before the progress bar; empty for none
};

/// Calls job(0) … job(count - 1), each once, in any order and on several threads. Jobs must be independent: each writes
/// to its own place, so that the result does not depend on the number of threads. Once a job throws no further one is
/// begun, and of the exceptions that of the lowest job is thrown again. A signal (stop_signal.hpp) ends it the same
/// way.
void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job);

}  // namespace hapbench
