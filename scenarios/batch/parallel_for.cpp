#include "scenarios/batch/parallel_for.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

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
  // An arena alone would not have more threads than the machine.
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

}  // namespace hapbench
