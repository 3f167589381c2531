#include "scenarios/run/drag_progress.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {

DragProgress::DragProgress(const DragHand& hand, double width, double duration)
    : hand_(hand), width_(width), half_path_(0.5 * std::min(hand.drag().speed * duration, hand.path().length())) {}

void DragProgress::add(double time, const Vec3& position) noexcept {
  // Update the progress of target point and tool, and the lag.
  const double target = std::min(hand_.drag().speed * time, hand_.path().length());
  now_ = {time, target, std::max(now_.tool, hand_.progress()), position};
  lag_ = now_.target - hand_.progress();
  if (now_.target <= half_path_) lag_at_half_path_ = lag_;
  // Take a sample whenever the target point has advanced by a quarter of the tool's width.
  if (now_.target < static_cast<double>(sample_count_) * width_ / kSamples) return;
  const Sample before = std::exchange(samples_[sample_count_ % kSamples], now_);
  if (sample_count_++ < kSamples) return;
  // Detect a standstill. Compare the tool's progress with its progress in `before`, the sample since which the target
  // point has advanced by one tool width. If the path leads back to a tool that stands still, the tool's progress grows
  // although the tool does not move. The growth therefore counts only up to the distance that the tool can have moved:
  // twice its largest distance from any of the samples, because the tool may have turned back.
  double moved = (position - before.position).norm();
  for (const Sample& sample : samples_) moved = std::max(moved, (position - sample.position).norm());
  if (std::min(now_.tool - before.tool, 2.0 * moved) >= kMinMovingFraction * (now_.target - before.target)) {
    stuck_.reset();
  } else if (!stuck_) {
    stuck_ = before;
  }
}

std::optional<Stuck> DragProgress::stuck() const {
  if (!stuck_) return std::nullopt;
  return Stuck{stuck_->time, now_.tool - stuck_->tool, now_.target - stuck_->target};
}

double DragProgress::tolerated_lag() const {
  return std::max({kMinMovingFraction * now_.target, 0.5 * width_, 2.0 * lag_at_half_path_});
}

}  // namespace hapbench
