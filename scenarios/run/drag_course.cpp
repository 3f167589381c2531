#include "scenarios/run/drag_course.hpp"

#include <algorithm>
#include <utility>

namespace hapbench {

DragCourse::DragCourse(const DragHand& hand, double width, double duration)
    : hand_(hand), width_(width), half_way_(0.5 * std::min(hand.drag().speed * duration, hand.path().length())) {}

void DragCourse::add(double time) noexcept {
  now_ = {time, std::min(hand_.drag().speed * time, hand_.path().length()), std::max(now_.way, hand_.nearest())};
  behind_ = now_.asked - hand_.nearest();
  if (now_.asked <= half_way_) behind_at_half_way_ = behind_;
  if (now_.asked < static_cast<double>(stand_) * width_ / kStands) return;
  const Stand before = std::exchange(stands_[stand_ % kStands], now_);
  if (stand_++ < kStands) return;
  if (now_.way - before.way >= kMovingShare * (now_.asked - before.asked)) {
    stuck_.reset();
  } else if (!stuck_) {
    stuck_ = before;
  }
}

std::optional<Stuck> DragCourse::stuck() const {
  if (!stuck_) return std::nullopt;
  return Stuck{stuck_->time, now_.way - stuck_->way, now_.asked - stuck_->asked};
}

std::optional<double> DragCourse::left_behind() const {
  const double most = std::max({kMovingShare * now_.asked, 0.5 * width_, 2.0 * behind_at_half_way_});
  return behind_ > most ? std::optional(behind_) : std::nullopt;
}

}  // namespace hapbench
