#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "device_model/hands/drag_hand.hpp"
#include "scenarios/run/stuck.hpp"

namespace hapbench {

/// Compares the progress of a dragged tool along its path with the progress of the hand's target point, to
/// detect a tool that is stuck or left behind.
class DragProgress {
 public:
  /// `hand` must outlive this object. `width`: width of the tool [m]; `duration`: duration of the run [s].
  DragProgress(const DragHand& hand, double width, double duration);

  /// Adds a step at `time` [s] with the tool at `position` [m].
  void add(double time, const Vec3& position) noexcept;

  /// Returns the interval in which the tool stood still until the end of the run; empty if the tool moved at the end.
  /// The tool stands still if, while the target point advances by one tool width, the tool advances by less than a
  /// tenth of this width.
  std::optional<Stuck> stuck() const;
  double progress() const { return now_.tool; }           ///< largest progress of the tool along the path [m]
  double target_progress() const { return now_.target; }  ///< progress of the target point along the path [m]
  double lag() const { return lag_; }  ///< lag of the tool along the path behind the target point [m]
  /// Returns the largest lag at the end with which the tool still counts as dragged [m]: the largest of a tenth of the
  /// target's progress, half the tool width, and twice the lag at half of the path. The last value includes a tool that
  /// friction holds back at a constant lag.
  double tolerated_lag() const;
  bool is_left_behind() const { return lag_ > tolerated_lag(); }

 private:
  /// Progress of the target point and of the tool along the path [m] at one time [s].
  struct Sample {
    double time = 0.0, target = 0.0, tool = 0.0;
    Vec3 position = Vec3::Zero();  ///< position of the tool [m]
  };
  static constexpr std::size_t kSamples = 4;
  const DragHand& hand_;
  double width_, half_path_;  ///< width of the tool; half the length of the target's path [m]
  /// Lag of the tool behind the target point [m]: in the last step, and at half of the path.
  double lag_ = 0.0, lag_at_half_path_ = 0.0;
  Sample now_;
  /// Ring buffer of samples, taken whenever the target point has advanced by a quarter of the tool's width.
  std::array<Sample, kSamples> samples_{};
  std::size_t sample_count_ = 0;  ///< number of samples taken so far
  std::optional<Sample> stuck_;   ///< sample at which the current standstill began; empty while the tool moves
};

}  // namespace hapbench
