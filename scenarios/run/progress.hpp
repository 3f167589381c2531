#pragma once

#include <string>

#include "scenarios/run/progress_bar.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// The progress bar of one run.
class Progress final : public Observer {
 public:
  /// `label` stands before the bar; `steps` is the whole. `enabled` false silences it (--quiet).
  Progress(std::string label, std::uint64_t steps, bool enabled) : bar_(std::move(label), steps, enabled) {}

  void on_step(const StepRecord& record) noexcept override {
    // Looking at the clock takes longer than some steps.
    if (bar_.is_on() && record.step % kLookEvery == 0) bar_.show(record.step);
  }

 private:
  static constexpr std::uint64_t kLookEvery = 1024;  // steps

  ProgressBar bar_;
};

}  // namespace hapbench
