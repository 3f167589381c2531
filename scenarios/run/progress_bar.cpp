#include "scenarios/run/progress_bar.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>

namespace hapbench {

namespace {

constexpr auto kSilence = std::chrono::seconds(2);
constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr std::size_t kWidth = 40;

thread_local ProgressListener* thread_listener = nullptr;

/// A line being made, without the heap: the bar is drawn within steps, which allocate nothing.
class Line {
 public:
  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const auto end =
        fmt::format_to_n(text_.data() + size_, text_.size() - size_, format, std::forward<Arguments>(arguments)...);
    size_ = std::min(size_ + end.size, text_.size());
  }
  /// "95 s", "12 min", "30 h"
  void add_time(double seconds) {
    const bool minutes = seconds >= 120.0, hours = seconds >= 7200.0;
    add("{:.0f} {}", seconds / (hours ? 3600.0 : minutes ? 60.0 : 1.0), hours ? "h" : minutes ? "min" : "s");
  }
  std::string_view text() const { return {text_.data(), size_}; }

 private:
  std::array<char, 512> text_;
  std::size_t size_ = 0;
};

/// Columns of the terminal behind standard error; 80 when it does not say.
std::size_t columns() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

void report_progress_to(ProgressListener* listener) noexcept {
  thread_listener = listener;
}

void show_status(std::string_view line) {
  const auto length = static_cast<int>(std::min(line.size(), columns() - 1));
  std::fprintf(stderr, "\r%.*s\033[K", length, line.data());
  std::fflush(stderr);
}

void hide_status() {
  std::fprintf(stderr, "\r\033[K");
}

ProgressBar::ProgressBar(std::string label, std::uint64_t total, bool enabled)
    : listener_(thread_listener),
      label_(std::move(label)),
      total_(total),
      enabled_(enabled && (listener_ != nullptr || isatty(STDERR_FILENO) == 1)),
      start_(Clock::now()),
      next_(start_ + kSilence) {}

ProgressBar::~ProgressBar() {
  if (drawn_) hide_status();
}

void ProgressBar::show(std::uint64_t done, bool counts) noexcept {
  if (!enabled_) return;
  if (listener_ != nullptr) {
    listener_->progress(label_, done, total_);
    return;
  }
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + kRedraw;
  drawn_ = true;
  const double part = static_cast<double>(done) / static_cast<double>(total_);
  Line numbers;
  numbers.add("{:3.0f} %", 100.0 * part);
  if (counts) {
    numbers.add(", {}/{}", done, total_);
    if (done > first_) {
      const double each = std::chrono::duration<double>(now - start_).count() / static_cast<double>(done - first_);
      numbers.add(", ");
      numbers.add_time(each * static_cast<double>(total_ - done));
      numbers.add(" left");
    }
  }
  // The bar is what gives way to a narrow terminal.
  const std::size_t others = label_.size() + numbers.text().size() + 5;
  const std::size_t width = std::clamp<std::size_t>(columns() - std::min(columns(), others), 10, kWidth);
  Line line;
  line.add("{} [", std::string_view(label_));
  for (std::size_t i = 0; i < width; ++i)
    line.add("{}", static_cast<double>(i) < part * static_cast<double>(width) ? '#' : '.');
  line.add("] {}", numbers.text());
  show_status(line.text());
}

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
  bool shown = false;
  for (int seconds = 1; !ended_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; }); ++seconds) {
    if (std::chrono::seconds(seconds) < kSilence) continue;
    show_status(fmt::format("{} ... {} s", what_, seconds));
    shown = true;
  }
  if (shown) hide_status();
}

}  // namespace hapbench
