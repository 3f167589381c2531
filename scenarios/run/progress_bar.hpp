#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

namespace hapbench {

/// Function that is called with the progress of work, in place of a bar on the terminal. May be called from any
/// thread. Must not throw.
using ProgressListener = std::function<void(std::string_view label, std::uint64_t done, std::uint64_t total)>;

/// Selects whether progress is shown: as a bar on the terminal, or through a listener.
struct Progress {
  /// Implicit conversion is allowed, so that a caller can pass `false` for work without a progress bar.
  Progress(bool shown = false, const ProgressListener* other = nullptr) : is_shown(shown), listener(other) {}

  bool is_shown;
  const ProgressListener* listener;  ///< called in place of drawing a bar; null: bars are drawn on the terminal
};

/// A progress line on standard error for work that takes longer than two seconds. On a terminal, the line is
/// redrawn in place. Otherwise a new line is printed after 2 s, 4 s, 8 s and so on. With a listener, nothing is
/// printed and the listener is called at every show().
class ProgressBar {
 public:
  /// `label`: start of the line; an empty label disables the bar (--quiet). `total`: number of work items. `listener`
  /// is called in place of drawing, and must outlive this object; null: the bar is drawn.
  ProgressBar(std::string label, std::uint64_t total, const ProgressListener* listener);
  /// Removes the line from the terminal.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Reports that `done` of the `total` items are finished. Redraws at most five times a second. If `counts` is true,
  /// also shows `done`, `total` and the estimated remaining time, which assumes the mean time per item so far.
  void show(std::uint64_t done, bool counts = false);

 private:
  using Clock = std::chrono::steady_clock;

  const ProgressListener* listener_;  ///< null: the bar is drawn
  std::string label_;
  std::uint64_t total_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point next_;
};

/// A status line on standard error for work of unknown length that takes longer than two seconds: what is
/// running, and for how many seconds.
class WaitNotice {
 public:
  /// `enabled`: false disables the line (--quiet).
  WaitNotice(const std::string& what, bool enabled) : WaitNotice([what] { return what; }, enabled) {}
  /// `what` is called for each line, from another thread.
  WaitNotice(std::function<std::string()> what, bool enabled);

 private:
  std::jthread thread_;  ///< shows the line, and removes it when this object is destroyed
};

}  // namespace hapbench
