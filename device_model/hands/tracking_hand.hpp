#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Parameters of a simulated subject of the man-machine experiments. The thesis did not measure its subjects, so all
/// values are ours; the defaults are within the ranges that the motor-control literature reports for a hand with a pen.
struct Subject {
  double reaction_delay = 0.2;     ///< from the display to the hand [s]
  double bandwidth = 0.6;          ///< bandwidth of following the target on the display [Hz]
  double stiffness = 300.0;        ///< stiffness of the hand about its intended position [N/m]
  double damping = 6.0;            ///< damping of the hand [N s/m]
  double press = 1.7;              ///< force along +z that the subject aims at on the gauge [N]
  double press_bandwidth = 0.4;    ///< bandwidth of correcting the force [Hz]
  double motor_noise = 0.04;       ///< standard deviation of each force component [N]
  double tilt_noise = 0.004;       ///< standard deviation of the angle of a turning wrist [rad]
  double noise_bandwidth = 8.0;    ///< first-order bandwidth of both noises [Hz]
  double height_per_tilt = 0.004;  ///< expected rise of the tip with the tilt [m/rad]
  double max_speed = 0.02;         ///< fastest motion of the intended position [m/s]
  double max_turn = 1.0;           ///< fastest turn of the wrist [rad/s]
  double max_force = 6.0;          ///< largest force in any axis; beyond it the arm yields [N]
};

/// The subject at the display, who follows one target after the other and presses the tool down. The subject perceives
/// one reaction delay late the distance from tip to target on the panel or height meter and the force gauge, without
/// delay the handle between the fingers. The action is an intended (equilibrium) position x_e:
///
///   f = k (x_e - x_handle) - b v_handle + motor noise
///
///   panel:  dx_e/dt = 2 pi f_v (target - tip) in x and y
///   height: dtilt/dt = 2 pi f_v (target - tip) / height_per_tilt, by the wrist; x_e rests in x and y
///   both:   dz_e/dt = -2 pi f_p (press - gauge) / k
///
/// each limited by the subject's speed and strength. Allocates in the constructor only.
class TrackingHand final : public Hand {
 public:
  /// initial_tilt: tilt of the wrist [rad], which turns with the height display only. dt: sampling interval [s].
  TrackingHand(const Subject& subject, TargetTask task, double initial_tilt, double dt, std::uint64_t seed);

  void reset() noexcept override;
  Vec3 force(double t, const HandView& view) noexcept override;
  const TargetTask* task() const noexcept override { return &task_; }

  /// The position of the handle that the subject intends, x_e [m].
  const Vec3& intended() const noexcept { return intended_; }
  /// Tilt of the tool, including noise [rad].
  double tilt() const noexcept { return tilt_; }

 private:
  /// The display at one sample.
  struct Seen {
    Vec3 error = Vec3::Zero();  ///< from tip to target, displayed components only
    double gauge = 0.0;
  };

  Seen look(const HandView& view) noexcept;
  void follow(const Seen& seen) noexcept;
  double coloured(double state) noexcept;

  Subject subject_;
  TargetTask task_;
  double initial_tilt_;
  double dt_;
  std::uint64_t seed_;
  double noise_memory_;  ///< correlation of the noise from sample to sample

  std::vector<Seen> seen_;  ///< ring of the samples within the reaction delay
  std::size_t next_ = 0;
  bool started_ = false;
  Random random_;
  Vec3 intended_ = Vec3::Zero();
  double wrist_ = 0.0;  ///< tilt without noise
  double tilt_ = 0.0;
  Vec3 force_noise_ = Vec3::Zero();  ///< in units of its standard deviation
  double tilt_noise_ = 0.0;          ///< in units of its standard deviation
};

/// The orientation of a tool that a tracking hand turns; the position is free.
class HeldOrientation final : public Motion {
 public:
  /// Takes the tilt from the hand, the rest from `orientation`. The hand must outlive the motion.
  HeldOrientation(Orientation orientation, const TrackingHand& hand)
      : orientation_(std::move(orientation)), hand_(&hand) {}

  Vec3 axis_at(double t) const noexcept override {
    return tool_axis(orientation_, hand_->tilt(), orientation_.azimuth(t));
  }
  double roll_at(double t) const noexcept override {
    return tool_roll(orientation_, hand_->tilt(), orientation_.azimuth(t), orientation_.roll(t));
  }
  bool scripts_roll() const noexcept override { return !orientation_.roll.is_constant(); }

 private:
  Orientation orientation_;
  const TrackingHand* hand_;
};

}  // namespace hapbench
