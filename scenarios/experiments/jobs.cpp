#include "scenarios/experiments/jobs.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "scenarios/run/progress.hpp"

namespace hapbench {
namespace {

/// What the threads share.
class JobList {
 public:
  JobList(std::size_t count, const std::string& label)
      : count_(count), failed_(count), bar_(label, count, !label.empty()) {}

  void work(const std::function<void(std::size_t)>& job) {
    for (std::size_t i = take(); i < count_; i = take()) {
      try {
        job(i);
      } catch (...) {
        fail(i);
      }
    }
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  /// The next job, or count_ when there is none.
  std::size_t take() {
    const std::lock_guard lock(mutex_);
    bar_.show(next_);
    return error_ ? count_ : std::min(count_, next_++);
  }
  void fail(std::size_t i) {
    const std::lock_guard lock(mutex_);
    if (i > failed_) return;
    failed_ = i;
    error_ = std::current_exception();
  }

  std::mutex mutex_;
  std::size_t count_;
  std::size_t next_ = 0;
  std::size_t failed_;
  std::exception_ptr error_;
  Progress bar_;
};

}  // namespace

void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job) {
  JobList list(count, options.label);
  const std::size_t threads = std::clamp<std::size_t>(options.threads, 1, std::max<std::size_t>(1, count));
  {
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < threads; ++i) others.emplace_back([&] { list.work(job); });
    list.work(job);
  }
  list.rethrow();
}

}  // namespace hapbench
