#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "scenarios/run/stuck.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Detects a tool that does not move although the target of the hand's spring moves. The spring belongs to a hand, or
/// to a simulated subject whose target is its intended position. A target that moves into the surface does not count,
/// because it only presses the tool against the surface. The target must therefore move away from the tool by more than
/// the tool's width perpendicular to the contact force.
class Standstill {
 public:
  /// `target(t)` returns the position of the spring's target at time t [s]. In each step, add() calls it with the time
  /// of this step. `width`: width of the tool [m].
  Standstill(std::function<Vec3(double)> target, double width) : target_(std::move(target)), width_(width) {}

  void add(const StepRecord& record) noexcept;

  /// Returns the standstill at the end of the run. Empty if the tool moved at the end of the run, or if its target did
  /// not move far enough.
  std::optional<Stuck> stuck() const;

 private:
  std::function<Vec3(double)> target_;
  double width_;
  Vec3 mean_force_ = Vec3::Zero();  ///< spring force of the contacts, averaged over about the last 32 steps [N]
  Box tool_box_, target_box_;  ///< bounding boxes of the positions of tool and target since the standstill began [m]
  /// Largest distance between target and tool perpendicular to the contact force since the standstill began [m].
  double across_ = 0.0;
  bool began_ = false;
  Stuck stuck_;
};

}  // namespace hapbench
