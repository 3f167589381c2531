#include "scenarios/run/drag_progress.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {

DragProgress::DragProgress(const DragHand& hand, double width, double duration)
    : hand_(hand), width_(width), half_path_(0.5 * std::min(hand.drag().speed * duration, hand.path().length())) {}

void DragProgress::add(double time) noexcept {
  // Update the progress of target point and tool, and the lag.
  now_ = {time, std::min(hand_.drag().speed * time, hand_.path().length()), std::max(now_.tool, hand_.nearest())};
  lag_ = now_.target - hand_.nearest();
  if (now_.target <= half_path_) lag_at_half_path_ = lag_;
  // Take a sample whenever the target point has advanced by a quarter of the tool's width.
  if (now_.target < static_cast<double>(sample_count_) * width_ / kSamples) return;
  const Sample before = std::exchange(samples_[sample_count_ % kSamples], now_);
  if (sample_count_++ < kSamples) return;
  // Compare with the sample one tool width ago: does the tool stand still?
  if (now_.tool - before.tool >= kMinMovingFraction * (now_.target - before.target)) {
    stuck_.reset();
  } else if (!stuck_) {
    stuck_ = before;
  }
}

std::optional<Stuck> DragProgress::stuck() const {
  if (!stuck_) return std::nullopt;
  return Stuck{stuck_->time, now_.tool - stuck_->tool, now_.target - stuck_->target};
}

std::optional<double> DragProgress::left_behind() const {
  const double tolerated = std::max({kMinMovingFraction * now_.target, 0.5 * width_, 2.0 * lag_at_half_path_});
  return lag_ > tolerated ? std::optional(lag_) : std::nullopt;
}

}  // namespace hapbench
