#include "scenarios/batch/parallel_for.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <numeric>
#include <vector>

#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/stop_signal.hpp"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace hapbench {
namespace {

/// Tells ThreadSanitizer that what was done before `give` is visible after `take`. It cannot see that oneTBB, which is
/// not instrumented, hands work from one thread to another. Does nothing in other builds.
class HandOver {
 public:
#ifdef __SANITIZE_THREAD__
  void give() {
    __tsan_release(this);
  }
  void take() {
    __tsan_acquire(this);
  }
#else
  void give() {}
  void take() {}
#endif
};

/// Keeps the exception of the lowest job that failed.
class Failure {
 public:
  bool has_error() {
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

void parallel_for(const NextRun& next, std::size_t jobs, const std::function<Delivery(std::size_t)>& work) {
  HandOver started, finished;
  started.give();
  const auto start = [&](tbb::flow_control& control) -> std::size_t {
    started.take();
    const auto run = next();
    started.give();
    if (!run) control.stop();
    return run.value_or(0);
  };
  const auto compute = [&](std::size_t run) {
    started.take();
    auto delivery = work(run);
    finished.give();
    return delivery;
  };
  const auto deliver = [&](const Delivery& delivery) {
    finished.take();
    if (delivery) delivery();
    finished.give();
  };
  using tbb::filter_mode;
  const auto pipeline = tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, start) &
                        tbb::make_filter<std::size_t, Delivery>(filter_mode::parallel, compute) &
                        tbb::make_filter<Delivery, void>(filter_mode::serial_out_of_order, deliver);
  // Without this an arena has at most as many threads as the machine.
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, jobs);
  tbb::task_arena arena(static_cast<int>(jobs));
  arena.execute([&] { tbb::parallel_pipeline(jobs, pipeline); });
  started.take();
  finished.take();
}

void parallel_for(std::span<const std::size_t> runs, std::size_t jobs, const std::function<Delivery(std::size_t)>& work,
                  const std::function<bool()>& stop) {
  auto at = runs.begin();
  const auto next = [&]() -> std::optional<std::size_t> {
    if (at == runs.end() || stop()) return std::nullopt;
    return *at++;
  };
  parallel_for(next, jobs, work);
}

std::size_t available_threads() {
  return static_cast<std::size_t>(tbb::info::default_concurrency());
}

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
  const auto stop = [&failure] { return failure.has_error() || StopSignal::received() != 0; };
  parallel_for(jobs, std::max<std::size_t>(1, options.threads), work, stop);
  failure.rethrow();
  if (done < count) throw_if_stopped();
}

}  // namespace hapbench
