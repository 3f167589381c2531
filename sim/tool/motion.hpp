#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "sim/core/math.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The tool's position, axis and roll in the world frame.
///
/// The axis is stored rather than computed from an orientation, because scripts give it and solids of revolution read
/// it; the roll completes it to a rotation. The tool's own frame has its origin at the tip centre and its axis along
/// -z.
struct ToolPose {
  Vec3 position = Vec3::Zero();  ///< centre of the tip [m]
  Vec3 axis = {0.0, 0.0, -1.0};  ///< unit vector out of the tip
  double roll = 0.0;             ///< turn about the axis, right-handed [rad]; see rotation()

  /// Rotation from the tool's frame to the world's: the shortest turn of -z to the axis (half a turn about x if the
  /// axis is +z), followed by the turn by `roll` about the axis.
  Mat3 rotation() const noexcept;
};

/// Pose and velocity. The orientation is scripted, so the angular velocity is known and not integrated.
struct ToolState {
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();  ///< of the tip centre [m/s]
  /// Over the previous step, low-passed if the algorithm asks for that [rad/s]; zero unless an algorithm reads it.
  /// Includes the turn about the axis if the pose or the script (Motion::scripts_roll) has one.
  Vec3 angular_velocity = Vec3::Zero();
};

/// The roll of the pose with this axis whose own x axis lies along `side`, in (-pi, pi]. Unit vectors, perpendicular.
double roll_towards(const Vec3& axis, const Vec3& side) noexcept;

/// The rotation vector of the shortest turn from unit vector a to unit vector b [rad]; zero for opposite ones.
inline Vec3 turn(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 cross = a.cross(b);
  const double sine = cross.norm();
  return sine > 0.0 ? Vec3(cross * (math::atan2(sine, a.dot(b)) / sine)) : Vec3::Zero();
}

/// The matrix of the shortest turn from one pose's axis to the other's, followed by the turn about that by the
/// difference of their rolls; exactly the identity where axes and rolls are equal.
Mat3 turn_matrix(const ToolPose& from, const ToolPose& to) noexcept;

/// The rotation vector that turns one pose to the other [rad]. If neither has a roll, that of the shortest turn of the
/// axis, because a solid of revolution, whose pose omits the roll, feels no other turn.
Vec3 turn(const ToolPose& from, const ToolPose& to) noexcept;

/// A scalar function of time, evaluated at any t [s] in O(1), for waypoints O(log n). The value's unit is the owner's.
class Profile {
 public:
  struct Constant {
    double value = 0.0;

    double at(double) const noexcept { return value; }
    double rate(double) const noexcept { return 0.0; }
  };
  /// start + rate_per_s * t
  struct Ramp {
    double start = 0.0;
    double rate_per_s = 0.0;

    double at(double t) const noexcept { return start + rate_per_s * t; }
    double rate(double) const noexcept { return rate_per_s; }
  };
  /// mean + amplitude * sin(2 pi t / period_s + phase_rad)
  struct Sine {
    double mean = 0.0;
    double amplitude = 0.0;
    double period_s = 1.0;
    double phase_rad = 0.0;

    double at(double t) const noexcept;
    double rate(double t) const noexcept;
  };
  enum class Interpolation { linear, cosine };
  /// (t [s], value) with strictly increasing times, held constant outside; `cosine` starts and ends each leg at rest.
  struct Waypoints {
    std::vector<std::pair<double, double>> points;
    Interpolation interpolation = Interpolation::linear;

    double at(double t) const noexcept;
    double rate(double t) const noexcept;
  };
  using Shape = std::variant<Constant, Ramp, Sine, Waypoints>;

  Profile() = default;
  Profile(double value) : shape_(Constant{value}) {}  // NOLINT: implicit, a number is a profile
  Profile(Shape shape) : shape_(std::move(shape)) {}  // NOLINT: implicit, a shape is a profile

  double operator()(double t) const noexcept;
  /// Time derivative at t [unit of the value / s]; at a waypoint, that of the leg that begins there.
  double rate(double t) const noexcept;
  const Shape& shape() const { return shape_; }
  bool is_constant() const { return std::holds_alternative<Constant>(shape_); }

 private:
  Shape shape_{Constant{}};
};

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
