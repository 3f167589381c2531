#include "scenarios/run/standstill.hpp"

#include <algorithm>

#include "scenarios/run/scene_distances.hpp"

namespace hapbench {

void Standstill::add(const StepRecord& record) noexcept {
  constexpr double kRows = 1 / 32.0;  // of a mean over some rows, which chatter does not turn
  const Vec3& place = record.tool.pose.position;
  const Vec3 target = target_(record.time);
  // Before the first touch nothing tells the direction of the push: how far away the target was then does not count.
  if (push_.isZero(0.0)) across_ = 0.0;
  push_ += kRows * (record.force.spring - push_);
  ways_.add(place);
  target_ways_.add(target);
  stuck_.way = diagonal(ways_);
  stuck_.target_way = diagonal(target_ways_);
  if (!began_ || stuck_.way > kMovingShare * std::max(width_, stuck_.target_way)) {
    began_ = true;
    ways_ = {place, place};
    target_ways_ = {target, target};
    across_ = stuck_.way = stuck_.target_way = 0.0;
    stuck_.since = record.time;
  }
  Vec3 across = target - place;
  if (const double push2 = push_.squaredNorm(); push2 > 0.0) across -= across.dot(push_) / push2 * push_;
  across_ = std::max(across_, across.norm());
}

std::optional<Stuck> Standstill::stuck() const {
  return stuck_.target_way > width_ && across_ > width_ ? std::optional(stuck_) : std::nullopt;
}

}  // namespace hapbench
