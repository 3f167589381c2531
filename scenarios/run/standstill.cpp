#include "scenarios/run/standstill.hpp"

#include <algorithm>

#include "scenarios/run/scene_distances.hpp"

namespace hapbench {

void Standstill::add(const StepRecord& record) noexcept {
  // Weight of a step in the running mean of the contact force. The mean removes chatter.
  constexpr double kMeanWeight = 1 / 32.0;
  const Vec3& position = record.tool.pose.position;
  const Vec3 target = target_(record.time);
  // Before the first contact, the direction of the contact force is unknown. The distances between target and tool in
  // these steps do not count.
  if (mean_force_.isZero(0.0)) across_ = 0.0;
  mean_force_ += kMeanWeight * (record.force.spring - mean_force_);
  // Extend the boxes of tool and target.
  tool_box_.add(position);
  target_box_.add(target);
  stuck_.tool_distance = diagonal(tool_box_);
  stuck_.target_distance = diagonal(target_box_);
  // If the tool moved, a possible standstill begins with this step.
  if (!began_ || stuck_.tool_distance > kMinMovingFraction * std::max(width_, stuck_.target_distance)) {
    began_ = true;
    tool_box_ = {position, position};
    target_box_ = {target, target};
    across_ = stuck_.tool_distance = stuck_.target_distance = 0.0;
    stuck_.since = record.time;
  }
  // Measure the distance to the target perpendicular to the contact force.
  Vec3 across = target - position;
  if (const double force2 = mean_force_.squaredNorm(); force2 > 0.0)
    across -= across.dot(mean_force_) / force2 * mean_force_;
  across_ = std::max(across_, across.norm());
}

std::optional<Stuck> Standstill::stuck() const {
  return stuck_.target_distance > width_ && across_ > width_ ? std::optional(stuck_) : std::nullopt;
}

}  // namespace hapbench
