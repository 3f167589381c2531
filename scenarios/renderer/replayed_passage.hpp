#pragma once

#include <memory>
#include <optional>
#include <string>

#include "device_model/live/live_renderer.hpp"
#include "results/observe/inside_observer.hpp"
#include "scenarios/run/checked_scenario.hpp"

namespace hapbench {

/// Detects, along a replayed log of a haptic loop, a tool that passes through the surface, by the rule of the outcome
/// `went_through` without its search for the deepest point of the tool. The renderer does not check this in the loop.
class ReplayedPassage {
 public:
  explicit ReplayedPassage(const CheckedScenario& scenario);

  /// Adds a call of the renderer. `time` [s]: since the first call.
  void add(const LiveRenderer& renderer, const HapbenchOutput& output, double time) noexcept;
  /// Returns true if the tool passed through the surface; empty if the environment has no solid.
  std::optional<bool> went_through() const;
  /// Returns a sentence on the first event of the passage; empty if the tool did not pass.
  std::string text() const;

 private:
  std::shared_ptr<const ToolShape> tool_;
  std::optional<InsideObserver> inside_;  ///< empty without a solid
  StepRecord record_;
};

}  // namespace hapbench
