#pragma once

#include <array>
#include <cstdint>

#include "results/observe/contact_forces.hpp"
#include "sim/loop/simulation.hpp"

/// Detection of bounces whose period is longer than 1/30 s, the period of the slowest vibration.
namespace hapbench {

/// Detects a tool that keeps bouncing with a period longer than 1 / kVibrationCutoff (1/30 s). In a bounce, the tool is
/// out of contact for longer than the preceding contact lasted, and the hand presses the tool back. The height of a
/// bounce is the largest distance of the handle from its last position in contact, along the last contact force.
class SlowBounces {
 public:
  /// `dt`: time step [s].
  explicit SlowBounces(double dt) : longest_vibration_(1.0 / (kVibrationCutoff * dt)) {}

  /// Adds one time step. Bounces are counted over the steps of `judged`.
  void add(const StepRecord& record, const EvaluationWindow& judged) noexcept;

  /// Returns true if each half of the judged steps has at least two bounces, and the highest bounce of the second
  /// half is at least 99 % as high as the highest bounce of the first half.
  bool persist() const noexcept;

 private:
  void touch(const StepRecord& record) noexcept;
  void leave(const StepRecord& record) noexcept;
  void land(std::uint64_t step, const EvaluationWindow& judged) noexcept;

  double longest_vibration_;            ///< number of steps in 1 / kVibrationCutoff, the longest period of a vibration
  std::uint64_t steps_in_contact_ = 0;  ///< duration of the last contact [steps]
  std::uint64_t steps_away_ = 0;        ///< steps since the last contact; 0 in contact
  Vec3 last_contact_ = Vec3::Zero();    ///< the handle's last position in contact [m]
  Vec3 up_ = Vec3::Zero();              ///< unit vector along the last contact force
  double height_ = 0.0;                 ///< height of the current bounce so far [m]
  bool is_pressed_ = false;             ///< true if the hand pressed towards the surface when the tool was at `height_`
  std::array<int, 2> counts_{};         ///< number of bounces in each half of the judged steps
  std::array<double, 2> highest_{};     ///< highest bounce in each half of the judged steps [m]
};

}  // namespace hapbench
