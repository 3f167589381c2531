#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

namespace hapbench {

/// Callback that stores the result of a finished run; called by one thread at a time. May be empty.
using Delivery = std::function<void()>;

/// Gives the next run, or none when no further one is to begin; called by one thread at a time.
using NextRun = std::function<std::optional<std::size_t>()>;

/// Calls `work` for the runs that `next` gives on up to `jobs` threads, and the deliveries it returns one at a time as
/// they come, in whatever order. Runs start in the order given, and no more than `jobs` are started and not delivered.
/// Results depend on `jobs` only if `work` or the deliveries depend on their order. An exception from any of them ends
/// it all and is thrown here. Threads are those of oneTBB. Costs some microseconds a run.
void parallel_for(const NextRun& next, std::size_t jobs, const std::function<Delivery(std::size_t run)>& work);
/// The same for a list. When `stop`, which is asked before each start, says so, the runs in flight are ended and no
/// other begins.
void parallel_for(std::span<const std::size_t> runs, std::size_t jobs,
                  const std::function<Delivery(std::size_t run)>& work, const std::function<bool()>& stop);

/// Number of threads that this process may use at once.
std::size_t available_threads();

}  // namespace hapbench
