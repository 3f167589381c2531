#pragma once

#include "sim/task/target_task.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

/// The handle the hand holds; the same as the tool for an ideal device.
struct HandleState {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
};

/// What the user of the device perceives in one step: the handle in the hand and the contents of the display.
struct HandView {
  HandleState handle;
  ToolPose tool;                     ///< on the display
  Vec3 model_force = Vec3::Zero();   ///< f_render of the step before, for the force gauge [N]
  Vec3 spring_force = Vec3::Zero();  ///< f_spring of the step before, for the force gauge [N]
};

/// Model of the human hand: its force on the handle as a function of time and of what it perceives.
class Hand {
 public:
  virtual ~Hand() = default;
  virtual void reset() noexcept = 0;
  /// Force of the hand on the handle at time t [N]. Called once a step.
  virtual Vec3 force(double t, const HandView& view) noexcept = 0;
  /// The targets the hand works on; null when it has no such task. Lives as long as the hand.
  virtual const TargetTask* task() const noexcept { return nullptr; }
  /// Returns true once the hand's task is finished; the run ends with that row.
  bool finished() const noexcept { return task() != nullptr && task()->finished(); }
};

}  // namespace hapbench
