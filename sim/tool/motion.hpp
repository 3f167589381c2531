#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sim/core/profile.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The scripted part of the tool's motion: always its orientation, and its position too if that is prescribed.
class Motion {
 public:
  virtual ~Motion() = default;
  /// Unit vector out of the tip at time t [s].
  virtual Vec3 axis_at(double t) const noexcept = 0;
  /// ToolPose::roll at time t [rad]; called only if something reads the roll.
  virtual double roll_at(double /*t*/) const noexcept { return 0.0; }
  /// True if the script turns the tool about its axis, so that the angular velocity even of a solid of revolution
  /// includes this turn; that of any other tool always does.
  virtual bool scripts_roll() const noexcept { return false; }
  /// True if the tip centre is integrated, false if position_at prescribes it.
  virtual bool position_is_free() const noexcept { return true; }
  /// Tip centre at time t [m]; called only if the position is not free.
  virtual Vec3 position_at(double /*t*/) const noexcept { return Vec3::Zero(); }
};

/// The tool leans by `tilt` from `up` towards lean', which is `lean` turned by `azimuth` about `up`:
/// axis = -(cos(tilt) up + sin(tilt) lean'), so at tilt 0 the tip points down. If all three angles are 0, the tool's
/// own x points along lean and its z along up; the roll turns it about its axis.
struct Orientation {
  Vec3 up = {0.0, 0.0, 1.0};    ///< unit
  Vec3 lean = {1.0, 0.0, 0.0};  ///< unit, perpendicular to up
  Profile tilt;                 ///< [rad]
  Profile azimuth;              ///< [rad], right-handed about up
  Profile roll = {};            ///< [rad], right-handed about the axis
};

/// The tool's axis at the given tilt and azimuth [rad] in place of the orientation's.
Vec3 tool_axis(const Orientation& orientation, double tilt, double azimuth) noexcept;
/// The pose's roll at the given angles [rad] in place of the orientation's.
double tool_roll(const Orientation& orientation, double tilt, double azimuth, double roll) noexcept;

/// Orientation from profiles; position free, or three profiles [m].
class ScriptedMotion final : public Motion {
 public:
  ScriptedMotion(Orientation orientation, std::optional<std::array<Profile, 3>> position);

  Vec3 axis_at(double t) const noexcept override;
  double roll_at(double t) const noexcept override;
  bool scripts_roll() const noexcept override { return !orientation_.roll.is_constant(); }
  bool position_is_free() const noexcept override { return !position_; }
  Vec3 position_at(double t) const noexcept override;

 private:
  Orientation orientation_;
  std::optional<Vec3> held_axis_;  ///< if neither tilt nor azimuth changes
  std::optional<std::array<Profile, 3>> position_;
};

/// A recorded stroke played back: linear interpolation between the samples, held constant outside. Orientations are
/// interpolated at constant angular velocity the short way round (slerp), axes without orientations linearly and
/// normalised, with a roll of 0.
class RecordedMotion final : public Motion {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 position = Vec3::Zero();
    Vec3 axis = {0.0, 0.0, -1.0};
    /// Rotation from the tool's frame to the world's, unit; determines the axis. Either all samples have one or none
    /// has.
    std::optional<Eigen::Quaterniond> orientation = {};
  };

  /// Throws std::invalid_argument if there is no sample, times do not increase or only some samples have an
  /// orientation.
  explicit RecordedMotion(std::vector<Sample> samples);

  std::span<const Sample> samples() const { return samples_; }
  Vec3 axis_at(double t) const noexcept override;
  double roll_at(double t) const noexcept override;
  bool scripts_roll() const noexcept override { return samples_.front().orientation.has_value(); }
  bool position_is_free() const noexcept override { return false; }
  Vec3 position_at(double t) const noexcept override;

 private:
  struct Leg {
    const Sample* from;
    const Sample* to;
    double fraction;
  };
  Leg leg_at(double t) const noexcept;
  static Eigen::Quaterniond orientation_in(const Leg& leg) noexcept;

  std::vector<Sample> samples_;
};

}  // namespace hapbench
