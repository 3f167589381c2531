#include "scenarios/batch/parallel_for.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

void parallel_for(const NextRun& next, std::size_t jobs, const std::function<Delivery(std::size_t)>& work) {
  std::mutex mutex;  // locked but while there is work to do
  std::exception_ptr failure;
  const auto work_on = [&] {
    std::unique_lock lock(mutex);
    try {
      while (const auto run = failure ? std::nullopt : next()) {
        lock.unlock();
        const Delivery delivery = work(*run);
        lock.lock();
        if (delivery && !failure) delivery();
      }
    } catch (...) {
      if (!lock) lock.lock();
      if (!failure) failure = std::current_exception();
    }
  };
  // What runs do in parallel by themselves takes no more threads than they.
  const tbb::global_control within(tbb::global_control::max_allowed_parallelism, std::min(jobs, available_threads()));
  {
    std::vector<std::jthread> others;
    try {
      while (others.size() + 1 < jobs) others.emplace_back(work_on);
    } catch (const std::system_error&) {
      // As many as the system gives.
    }
    work_on();
  }
  if (failure) std::rethrow_exception(failure);
}

std::size_t available_threads() {
  return static_cast<std::size_t>(tbb::info::default_concurrency());
}

void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job) {
  ProgressBar bar(options.label, count, !options.label.empty());
  std::atomic<bool> has_failed = false;
  std::size_t begun = 0, done = 0, lowest = count;
  std::exception_ptr error;  // of the lowest job that failed
  const auto next = [&]() -> std::optional<std::size_t> {
    const bool ends = begun == count || has_failed || StopSignal::received() != 0;
    return ends ? std::nullopt : std::optional(begun++);
  };
  const auto work = [&](std::size_t i) -> Delivery {
    try {
      job(i);
    } catch (...) {
      has_failed = true;
      return [&, i, caught = std::current_exception()] {
        if (i < lowest) error = caught;
        lowest = std::min(lowest, i);
      };
    }
    return [&] { bar.show(++done); };
  };
  parallel_for(next, std::clamp<std::size_t>(options.threads, 1, std::max<std::size_t>(count, 1)), work);
  if (error) std::rethrow_exception(error);
  if (done < count) throw_if_stopped();
}

}  // namespace hapbench
