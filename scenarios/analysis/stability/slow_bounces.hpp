#pragma once

#include <array>
#include <cstdint>

#include "results/observe/contact_forces.hpp"
#include "sim/loop/simulation.hpp"

/// Bounces that are slower than the vibration of a handle (30 Hz).
namespace hapbench {

/// Detects a tool that goes on bouncing more slowly than what counts as vibration. In a bounce the tool leaves the
/// surface for longer than the contact before it lasted, and returns against a hand that presses. The height of a
/// bounce is the largest distance from the position where the handle lost contact, along the force there.
class SlowBounces {
 public:
  /// `dt`: time step [s].
  explicit SlowBounces(double dt) : longest_vibration_(1.0 / (kVibrationCutoff * dt)) {}

  void add(const StepRecord& record, const JudgedRows& judged) noexcept;

  /// Returns true if each half of the judged rows has two bounces or more, and those of the second half do not get
  /// lower by 1 %.
  bool go_on() const noexcept;

 private:
  void touch(const StepRecord& record) noexcept;
  void fly(const StepRecord& record) noexcept;
  void land(std::uint64_t step, const JudgedRows& judged) noexcept;

  double longest_vibration_;          ///< rows of a period of the cutoff
  std::uint64_t rows_touching_ = 0;   ///< of the last contact
  std::uint64_t rows_away_ = 0;       ///< since then
  Vec3 last_contact_ = Vec3::Zero();  ///< the handle's last position in contact [m]
  Vec3 up_ = Vec3::Zero();            ///< direction of the last force
  double height_ = 0.0;               ///< of the current bounce so far [m]
  bool is_pressed_ = false;           ///< the hand pressed at this height
  std::array<int, 2> counts_{};       ///< in each half of the judged rows
  std::array<double, 2> highest_{};   ///< likewise [m]
};

}  // namespace hapbench
