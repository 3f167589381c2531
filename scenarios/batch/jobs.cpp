#include "scenarios/batch/jobs.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <numeric>
#include <vector>

#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

/// The exception of the lowest job that failed.
class Failure {
 public:
  bool is_there() {
    const std::lock_guard lock(mutex_);
    return error_ != nullptr;
  }
  void note(std::size_t job) {
    const std::lock_guard lock(mutex_);
    if (error_ && job > job_) return;
    job_ = job;
    error_ = std::current_exception();
  }
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::size_t job_ = 0;
  std::exception_ptr error_;
};

}  // namespace

void for_each_job(std::size_t count, const JobOptions& options, const std::function<void(std::size_t)>& job) {
  std::vector<std::size_t> jobs(count);
  std::iota(jobs.begin(), jobs.end(), std::size_t{0});
  ProgressBar bar(options.label, count, !options.label.empty());
  Failure failure;
  std::size_t done = 0;
  const auto work = [&](std::size_t i) -> Delivery {
    try {
      job(i);
    } catch (...) {
      failure.note(i);
    }
    return [&] { bar.show(++done); };
  };
  const auto stop = [&failure] { return failure.is_there() || StopSignal::received() != 0; };
  parallel_for(jobs, std::max<std::size_t>(1, options.threads), work, stop);
  failure.rethrow();
  if (done < count) throw_if_stopped();
}

}  // namespace hapbench
