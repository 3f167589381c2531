#pragma once

#include "sim/task/target_task.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// The handle the hand holds; the same as the tool for an ideal device.
struct HandleState {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

/// What a person at the device perceives in one step: the handle between the fingers and what the display shows.
struct HandView {
  HandleState handle;
  ToolPose tool;                    ///< on the display
  Vec3 model_force = Vec3::Zero();  ///< f_render of the step before, on the force gauge [N]
};

/// The human hand: what it pushes with, given time and what it perceives.
class Hand {
 public:
  virtual ~Hand() = default;
  virtual void reset() noexcept = 0;
  /// Force of the hand on the handle at time t [N]. Called once a step.
  virtual Vec3 force(double t, const HandView& view) noexcept = 0;
  /// The targets the hand works on; null when it has no such task. Lives as long as the hand.
  virtual const TargetTask* task() const noexcept { return nullptr; }
  /// True once the hand has nothing left to do; the run ends with that row.
  bool finished() const noexcept { return task() != nullptr && task()->finished(); }
};

}  // namespace hapbench
