#pragma once

#include <csignal>

namespace hapbench {

/// While it lives, the first SIGINT or SIGTERM is noted only, so that work can come to a clean end; the second ends the
/// process as usual. Signals that were ignored stay so. One at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// The signal that came, or 0. For any thread.
  int received() const noexcept;

 private:
  struct sigaction before_[2];
};

}  // namespace hapbench
