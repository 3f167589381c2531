#pragma once

#include <chrono>
#include <string>

#include "sim/loop/observer.hpp"

namespace hapbench {

/// A progress bar on standard error for work that takes longer than two seconds; silent otherwise, and when standard
/// error is no terminal.
class Progress final : public Observer {
 public:
  /// `label` stands before the bar; `steps` is the whole, in steps or in other parts. `enabled` false silences it
  /// (--quiet).
  Progress(std::string label, std::uint64_t steps, bool enabled);
  /// Removes the bar.
  ~Progress() override;

  void on_step(const StepRecord& record) noexcept override;
  /// Shows that `done` of the whole are done, if it is time to. For other work than steps.
  void show(std::uint64_t done) noexcept;

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  std::uint64_t steps_;
  bool enabled_;
  bool drawn_ = false;
  Clock::time_point next_;
};

}  // namespace hapbench
