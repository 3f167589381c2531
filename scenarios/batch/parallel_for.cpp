#include "scenarios/batch/parallel_for.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>

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

}  // namespace

void parallel_for(const NextRun& next, std::size_t jobs, const std::function<Delivery(std::size_t)>& work) {
  HandOver started, finished;
  // An exception that leaves a stage of the pipeline would leak the deliveries of the runs that are under way.
  std::exception_ptr failure;
  std::atomic<bool> has_failed = false;
  started.give();
  const auto start = [&](tbb::flow_control& control) -> std::size_t {
    started.take();
    const auto run = has_failed ? std::nullopt : next();
    started.give();
    if (!run) control.stop();
    return run.value_or(0);
  };
  const auto compute = [&](std::size_t run) {
    started.take();
    Delivery delivery;
    try {
      delivery = work(run);
    } catch (...) {
      delivery = [caught = std::current_exception()] { std::rethrow_exception(caught); };
    }
    finished.give();
    return delivery;
  };
  const auto deliver = [&](const Delivery& delivery) {
    finished.take();
    try {
      if (delivery && !failure) delivery();
    } catch (...) {
      failure = std::current_exception();
      has_failed = true;
    }
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
  parallel_for(next, std::max<std::size_t>(1, options.threads), work);
  if (error) std::rethrow_exception(error);
  if (done < count) throw_if_stopped();
}

}  // namespace hapbench
