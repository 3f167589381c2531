#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace hapbench {

/// A line on standard error that says what takes so long, with the seconds, for work of unknown length that takes
/// longer than two of them; silent otherwise, and when standard error is no terminal.
class WaitNotice {
 public:
  /// `enabled` false silences it (--quiet).
  WaitNotice(std::string what, bool enabled);
  /// Removes the line.
  ~WaitNotice();
  WaitNotice(const WaitNotice&) = delete;
  WaitNotice& operator=(const WaitNotice&) = delete;

 private:
  void show();

  std::string what_;
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::thread thread_;
};

}  // namespace hapbench
