#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"
#include "sim/tool/motion.hpp"

namespace hapbench {

/// Parameters of a simulated subject of the man-machine experiments (thesis appendix D). The thesis did not measure
/// its subjects, so all values were chosen for this project. The defaults are within the ranges that the motor-control
/// literature reports for a hand with a pen.
struct Subject {
  double reaction_delay = 0.2;     ///< time from a change on the display to the hand's response [s]
  double bandwidth = 0.6;          ///< bandwidth f_v of following the target on the display [Hz]
  double stiffness = 300.0;        ///< stiffness k of the hand about its intended position [N/m]
  double damping = 6.0;            ///< damping b of the hand [N s/m]
  double press = 1.7;              ///< force along +z that the subject tries to keep on the gauge [N]
  double press_bandwidth = 0.4;    ///< bandwidth f_p of correcting this force [Hz]
  double motor_noise = 0.04;       ///< standard deviation of each force component [N]
  double tilt_noise = 0.004;       ///< standard deviation of the wrist's angle (height display only) [rad]
  double noise_bandwidth = 8.0;    ///< bandwidth of both noises (first-order low-pass) [Hz]
  double height_per_tilt = 0.004;  ///< rise of the tip per tilt that the subject expects [m/rad]
  double max_speed = 0.02;         ///< largest speed of the intended position [m/s]
  double max_turn = 1.0;           ///< largest angular speed of the wrist [rad/s]
  double max_force = 6.0;          ///< largest force k (x_e - x_handle) in each axis [N]; x_e moves to keep this limit
};

/// A simulated subject who follows one target after the other on a display and presses the tool down. The subject
/// perceives the distance from tip to target (on the panel or height meter) and the force gauge with a reaction
/// delay, and the handle between the fingers without delay. The action is an intended (equilibrium) position x_e:
///
///   f = k (x_e - x_handle) - b v_handle + motor noise
///
///   panel:  dx_e/dt = 2 pi f_v (target - tip) in x and y
///   height: dtilt/dt = 2 pi f_v (target - tip) / height_per_tilt, by the wrist; x_e rests in x and y
///   both:   dz_e/dt = -2 pi f_p (press - gauge) / k
///
/// The rates of x_e and of the tilt are limited by the subject's speed and strength. f_v and f_p are the bandwidths
/// of Subject. Allocates only in the constructor.
class TrackingHand final : public Hand {
 public:
  /// `initial_tilt`: tilt of the wrist at the start [rad]. The tilt changes later only if the display is the height
  /// meter. `dt`: sampling interval [s].
  TrackingHand(const Subject& subject, TargetTask task, double initial_tilt, double dt, std::uint64_t seed);

  void reset() noexcept override;
  Vec3 force(double t, const HandView& view) noexcept override;
  /// Returns the linearisation with the intended position held constant, because the subject corrects this position
  /// more slowly than 1 Hz.
  HandImpedance impedance() const noexcept override {
    return {subject_.stiffness * Mat3::Identity(), subject_.damping * Mat3::Identity()};
  }
  const TargetTask* task() const noexcept override { return &task_; }

  /// Returns the handle position x_e that the subject intends [m].
  const Vec3& intended() const noexcept { return intended_; }
  /// Returns the tilt of the tool, including noise [rad].
  double tilt() const noexcept { return tilt_; }

 private:
  /// Values that the display shows in one sample.
  struct Display {
    Vec3 error = Vec3::Zero();  ///< displayed components of the vector from tip to target [m]
    double gauge = 0.0;         ///< force shown on the gauge [N]
  };

  Display delayed_display(const HandView& view) noexcept;
  void follow(const Display& seen) noexcept;
  double next_noise(double state) noexcept;

  Subject subject_;
  TargetTask task_;
  double initial_tilt_;
  double dt_;
  std::uint64_t seed_;
  double noise_memory_;  ///< correlation coefficient of the noise between consecutive samples

  std::vector<Display> seen_;  ///< ring buffer of the displays within the reaction delay
  std::size_t next_ = 0;
  bool started_ = false;  ///< true after intended_ has been set to the handle's initial position
  Random random_;
  Vec3 intended_ = Vec3::Zero();
  double wrist_ = 0.0;  ///< tilt without noise [rad]
  double tilt_ = 0.0;
  Vec3 force_noise_ = Vec3::Zero();  ///< noise of the force, in units of its standard deviation
  double tilt_noise_ = 0.0;          ///< noise of the tilt, in units of its standard deviation
};

/// Orientation of a tool whose tilt a tracking hand controls. The position is free.
class HeldOrientation final : public Motion {
 public:
  /// Uses the hand's tilt, and azimuth and roll of `orientation`. Precondition: the hand outlives this object.
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
