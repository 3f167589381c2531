#pragma once

#include "sim/task/target_task.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// The handle held by the hand; the same as the tool for an ideal device.
struct HandleState {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

/// The user's perception in one step: the handle in the hand and the contents of the display.
struct HandView {
  HandleState handle;
  ToolPose tool;                     ///< on the display
  Vec3 model_force = Vec3::Zero();   ///< f_render of the previous step, for gauge and task [N]
  Vec3 spring_force = Vec3::Zero();  ///< f_spring of the previous step, for gauge and task [N]
};

/// Model of the human hand: its force on the handle as a function of time and perception.
class Hand {
 public:
  virtual ~Hand() = default;
  virtual void reset() noexcept = 0;
  /// Force of the hand on the handle at time t [N]. Called once a step.
  virtual Vec3 force(double t, const HandView& view) noexcept = 0;
  /// The target task of the hand, or null. Lives as long as the hand.
  virtual const TargetTask* task() const noexcept { return nullptr; }
  /// True once the hand's task is finished; the run ends with that row.
  bool finished() const noexcept { return task() != nullptr && task()->finished(); }
};

}  // namespace hapbench
