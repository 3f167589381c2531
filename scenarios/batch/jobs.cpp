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
namespace {

/// State that the threads of for_each_job() share.
class JobQueue {
 public:
  JobQueue(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job)
      : count_(count), job_(job), bar_(options.label, count, options.listener) {}

  /// Returns a lock. While it is held, no thread starts a job.
  std::unique_lock<std::mutex> hold() { return std::unique_lock(mutex_); }

  /// Runs jobs until no job is left, a job fails, or a signal arrives.
  void work() {
    std::unique_lock lock(mutex_);
    while (begun_ < count_ && errors_.empty() && StopSignal::received() == 0) {
      const std::size_t i = begun_++;
      lock.unlock();
      const std::exception_ptr caught = error_of(i);
      lock.lock();
      if (caught)
        errors_.emplace(i, caught);
      else
        bar_.show(++done_, true);
    }
  }

  /// Records an error that kept a thread from starting. Precondition: the lock of hold() is held.
  void fail_to_start(const std::string& text) { errors_.emplace(0, std::make_exception_ptr(std::runtime_error(text))); }

  /// If a job failed, rethrows the exception of the failed job with the lowest number. Otherwise, if a signal stopped
  /// the work before all jobs were done, throws Stopped. Precondition: no thread is working any more.
  void rethrow() const {
    if (!errors_.empty()) std::rethrow_exception(errors_.begin()->second);
    if (done_ < count_) throw_if_stopped();
  }

 private:
  std::exception_ptr error_of(std::size_t i) const noexcept {
    try {
      job_(i);
      return nullptr;
    } catch (...) {
      return std::current_exception();
    }
  }

  const std::size_t count_;
  const std::function<void(std::size_t)>& job_;
  ProgressBar bar_;
  std::mutex mutex_;  // protects the members below; unlocked only while a job runs
  std::size_t begun_ = 0, done_ = 0;
  std::map<std::size_t, std::exception_ptr> errors_;  // key: number of the job
};

}  // namespace

std::size_t available_threads() {
  return static_cast<std::size_t>(tbb::info::default_concurrency());
}

void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job) {
  JobQueue queue(count, options, job);
  const std::size_t threads = std::max(1u, options.threads);
  // A job may itself use TBB. Limit the threads of TBB to the number of jobs that run at the same time.
  const tbb::global_control within(tbb::global_control::max_allowed_parallelism,
                                   std::min(threads, available_threads()));
  std::vector<std::jthread> others;
  std::unique_lock starting = queue.hold();  // no job starts before all threads exist
  try {
    while (others.size() + 1 < std::min(threads, count)) others.emplace_back([&queue] { queue.work(); });
  } catch (const std::exception& reason) {
    queue.fail_to_start(fmt::format("{}; if threads or memory ran short: fewer --jobs", reason.what()));
  }
  starting.unlock();
  queue.work();
  others.clear();
  queue.rethrow();
}

}  // namespace hapbench
