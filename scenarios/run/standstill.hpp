#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "scenarios/run/stuck.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Finds a tool that the spring of a hand, or of a subject that aims at an intended position, cannot move. A spring
/// whose target goes into the surface only presses the tool on it: the target must come away from the tool by more than
/// its width across the push of the contacts' springs.
class Standstill {
 public:
  /// `target`: of the spring, at the time of the row that was the last [s]. `width`: the tool's [m].
  Standstill(std::function<Vec3(double)> target, double width) : target_(std::move(target)), width_(width) {}

  void add(const StepRecord& record) noexcept;

  /// Empty where the tool moves in the end, or its target does not.
  std::optional<Stuck> stuck() const;

 private:
  std::function<Vec3(double)> target_;
  double width_;
  Vec3 push_ = Vec3::Zero();  ///< spring force, its mean over the last rows [N]
  Box ways_, target_ways_;    ///< around the places of tool and target since it stands
  double across_ = 0.0;       ///< furthest that the target was from the tool across the push since then [m]
  bool began_ = false;
  Stuck stuck_;
};

}  // namespace hapbench
