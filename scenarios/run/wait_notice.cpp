#include "scenarios/run/wait_notice.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "scenarios/run/progress_bar.hpp"

namespace hapbench {

WaitNotice::WaitNotice(std::string what, bool enabled) : what_(std::move(what)) {
  if (!enabled || isatty(STDERR_FILENO) != 1) return;
  // Signals stay with the threads that wait for them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::thread([this] { show(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

WaitNotice::~WaitNotice() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

void WaitNotice::show() {
  std::unique_lock lock(mutex_);
  constexpr int silence = 2;  // [s]
  bool shown = false;
  for (int seconds = 1; !ended_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; }); ++seconds) {
    if (seconds < silence) continue;
    show_status(fmt::format("{} ... {} s", what_, seconds));
    shown = true;
  }
  if (shown) hide_status();
}

}  // namespace hapbench
