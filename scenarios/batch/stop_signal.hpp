#pragma once

#include <csignal>

namespace hapbench {

/// While an object of this class exists, the first SIGINT or SIGTERM is only recorded, so that work can end cleanly;
/// the second one terminates the process as usual. Signals that were ignored stay ignored. At most one object may exist
/// at a time.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// Returns the signal received, or 0. May be called from any thread.
  int received() const noexcept;

 private:
  struct sigaction before_[2];
};

}  // namespace hapbench
