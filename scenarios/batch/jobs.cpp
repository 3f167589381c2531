#include "scenarios/batch/jobs.hpp"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include <algorithm>
#include <exception>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

std::size_t available_threads() {
  return static_cast<std::size_t>(tbb::info::default_concurrency());
}

void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job) {
  ProgressBar bar(options.label, count);
  std::mutex mutex;  // of all below; unlocked only while a job runs
  std::size_t begun = 0, done = 0;
  std::map<std::size_t, std::exception_ptr> errors;  // by job
  const auto work = [&] {
    std::unique_lock lock(mutex);
    while (begun < count && errors.empty() && StopSignal::received() == 0) {
      const std::size_t i = begun++;
      std::exception_ptr caught;
      lock.unlock();
      try {
        job(i);
      } catch (...) {
        caught = std::current_exception();
      }
      lock.lock();
      if (caught)
        errors.emplace(i, caught);
      else
        bar.show(++done, true);
    }
  };
  const std::size_t threads = std::max(1u, options.threads);
  // A job may itself use TBB: that gets no more threads than there are jobs at once.
  const tbb::global_control within(tbb::global_control::max_allowed_parallelism,
                                   std::min(threads, available_threads()));
  std::unique_lock starting(mutex);  // no job begins before all threads are there
  std::vector<std::jthread> others;
  try {
    while (others.size() + 1 < std::min(threads, count)) others.emplace_back(work);
  } catch (const std::exception& reason) {
    const std::string text = fmt::format("{}; if threads or memory ran short: fewer --jobs", reason.what());
    errors.emplace(0, std::make_exception_ptr(std::runtime_error(text)));
  }
  starting.unlock();
  work();
  others.clear();
  if (!errors.empty()) std::rethrow_exception(errors.begin()->second);
  if (done < count) throw_if_stopped();
}

}  // namespace hapbench
