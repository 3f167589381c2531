#include "scenarios/run/progress_bar.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <mutex>
#include <utility>

namespace hapbench {
namespace {

// kSilence: time before the first progress line. kRedraw: shortest time between two redraws on a terminal.
constexpr auto kSilence = std::chrono::seconds(2);
constexpr auto kRedraw = std::chrono::milliseconds(200);

/// Returns the number of columns of the terminal; 80 if it is unknown.
std::size_t columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

bool is_terminal() {
  return isatty(STDERR_FILENO) == 1;
}

/// Prints a line. On a terminal, it replaces the previous line and is cut to the terminal's width, because a
/// wrapped line could not be overwritten.
void show_status(std::string_view line) {
  if (!is_terminal()) {
    std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
    return;
  }
  const auto length = static_cast<int>(std::min(line.size(), columns() - 1));
  std::fprintf(stderr, "\r%.*s\033[K", length, line.data());
  std::fflush(stderr);
}

/// Removes the line from a terminal.
void hide_status() {
  if (is_terminal()) std::fprintf(stderr, "\r\033[K");
}

/// Prints what() and the elapsed seconds repeatedly until a stop is requested. The first line appears after 2 s. On a
/// terminal, the line is updated every second; otherwise a new line is printed after 4 s, 8 s and so on.
void show_seconds(const std::function<std::string()>& what, const std::stop_token& ends) {
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  bool shown = false;
  int next = static_cast<int>(kSilence.count());
  const auto has_ended = [&ends] { return ends.stop_requested(); };
  for (int seconds = 1; !ended.wait_for(lock, ends, std::chrono::seconds(1), has_ended); ++seconds) {
    if (seconds < next) continue;
    next = is_terminal() ? seconds + 1 : 2 * seconds;
    show_status(fmt::format("{} ... {} s", what(), seconds));
    shown = true;
  }
  if (shown) hide_status();
}

}  // namespace

ProgressBar::ProgressBar(std::string label, std::uint64_t total, const ProgressListener* listener)
    : listener_(listener), label_(std::move(label)), total_(total), start_(Clock::now()), next_(start_ + kSilence) {}

ProgressBar::~ProgressBar() {
  if (drawn_) hide_status();
}

void ProgressBar::show(std::uint64_t done, bool counts) {
  if (label_.empty()) return;
  if (listener_ != nullptr) return (*listener_)(label_, done, total_);
  const auto now = Clock::now();
  if (now < next_ || (done == total_ && !is_terminal())) return;
  next_ = is_terminal() ? now + kRedraw : now + (now - start_);
  drawn_ = true;
  // Formats into a buffer on the stack: show() is called between simulation steps, where nothing may be
  // allocated.
  fmt::memory_buffer line;
  const auto to = fmt::appender(line);
  fmt::format_to(to, "{}: {:3.0f} %", label_, 100.0 * static_cast<double>(done) / static_cast<double>(total_));
  if (counts) fmt::format_to(to, ", {}/{}", done, total_);
  // Estimate the remaining time from the mean time per item.
  if (counts && done > 0) {
    const double each = std::chrono::duration<double>(now - start_).count() / static_cast<double>(done);
    const double seconds = each * static_cast<double>(total_ - done);
    const auto [unit, name] = seconds >= 7200.0  ? std::pair(3600.0, "h")
                              : seconds >= 120.0 ? std::pair(60.0, "min")
                                                 : std::pair(1.0, "s");
    fmt::format_to(to, ", {:.0f} {} left", seconds / unit, name);
  }
  show_status({line.data(), line.size()});
}

WaitNotice::WaitNotice(std::function<std::string()> what, bool enabled) {
  if (!enabled) return;
  // Block all signals in the new thread, so that only threads that expect signals receive them.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  thread_ = std::jthread([what = std::move(what)](const std::stop_token& ends) { show_seconds(what, ends); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace hapbench
