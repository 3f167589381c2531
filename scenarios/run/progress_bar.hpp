#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

namespace hapbench {

/// Hears of progress in place of the terminal, from any thread. Throws nothing.
using ProgressListener = std::function<void(std::string_view label, std::uint64_t done, std::uint64_t total)>;

/// Whether the progress of work is shown, and to whom.
struct Progress {
  /// A bar on the terminal, or none. Not explicit, because most work is shown to nobody.
  Progress(bool shown = false, const ProgressListener* other = nullptr) : is_shown(shown), listener(other) {}

  bool is_shown;
  const ProgressListener* listener;  ///< hears of bars in place of the terminal; null: they are drawn
};

/// How much is done, as a line on standard error for work that takes longer than two seconds; silent otherwise. Where
/// standard error is not a terminal, a line after 2 s, 4 s, 8 s and so on. A listener is told of every `show`.
class ProgressBar {
 public:
  /// `label` begins the line; an empty one silences it (--quiet). `listener`: null to draw; must outlive this.
  ProgressBar(std::string label, std::uint64_t total, const ProgressListener* listener);
  /// Removes the line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Shows how much is done, now and then. With `counts` also the numbers and the time that is left, if the rest takes
  /// as long for each as what was done since the bar was made.
  void show(std::uint64_t done, bool counts = false) noexcept;

 private:
  using Clock = std::chrono::steady_clock;

  const ProgressListener* listener_;  ///< may be null
  std::string label_;
  std::uint64_t total_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point next_;
};

/// As ProgressBar for work of unknown length: a line on standard error with what takes so long, and the seconds.
class WaitNotice {
 public:
  /// `enabled` false silences it (--quiet).
  WaitNotice(const std::string& what, bool enabled) : WaitNotice([what] { return what; }, enabled) {}
  /// `what` is asked for each line, from another thread.
  WaitNotice(std::function<std::string()> what, bool enabled);

 private:
  std::jthread thread_;  ///< shows the line, and removes it when this object goes
};

}  // namespace hapbench
