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

/// Pose of the tool in the world frame: position, axis and roll.
///
/// The axis is stored, instead of being computed from an orientation, because scripts define the axis and solids of
/// revolution use nothing else. The roll completes the axis to a rotation. The tool's own frame has its origin at the
/// tip centre and its axis along -z.
struct ToolPose {
  Vec3 position = Vec3::Zero();  ///< centre of the tip [m]
  Vec3 axis = {0.0, 0.0, -1.0};  ///< unit vector along the axis, out of the tip
  double roll = 0.0;             ///< rotation about the axis, right-handed [rad]; see rotation()

  /// Returns the rotation matrix from the tool frame to the world frame: the shortest rotation from -z to the axis
  /// (by 180 degrees about x if the axis is +z), followed by the rotation by `roll` about the axis.
  Mat3 rotation() const noexcept;
};

/// Pose and velocity of the tool. The orientation is scripted, so its angular velocity is known and not integrated.
struct ToolState {
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();  ///< velocity of the tip centre [m/s]
  /// Angular velocity over the previous step [rad/s], low-pass filtered if the algorithm requests it. Zero if the
  /// algorithm does not read it. Includes the rotation about the tool's axis if the pose includes the roll, or if the
  /// script rotates the tool about its axis (Motion::scripts_roll).
  Vec3 angular_velocity = Vec3::Zero();
};

/// Returns the roll in (-pi, pi] of a pose with this axis that makes the tool's own x axis point along `side`.
/// Precondition: `axis` and `side` are perpendicular unit vectors.
double roll_towards(const Vec3& axis, const Vec3& side) noexcept;

/// Returns the rotation vector of the shortest rotation from unit vector a to unit vector b [rad]; zero if they are
/// opposite.
inline Vec3 turn(const Vec3& a, const Vec3& b) noexcept {
  const Vec3 cross = a.cross(b);
  const double sine = cross.norm();
  return sine > 0.0 ? Vec3(cross * (math::atan2(sine, a.dot(b)) / sine)) : Vec3::Zero();
}

/// Returns the rotation matrix from one pose to another: the shortest rotation between the axes, followed by a
/// rotation about the new axis by the difference of the rolls. Exactly the identity if axes and rolls are equal.
Mat3 turn_matrix(const ToolPose& from, const ToolPose& to) noexcept;

/// Returns the rotation vector from one pose to another [rad]. If both rolls are 0, the result is the shortest rotation
/// between the axes: the pose of a solid of revolution omits the roll, and a rotation about the axis does not change
/// such a pose.
Vec3 turn(const ToolPose& from, const ToolPose& to) noexcept;

/// Scalar function of time t [s]. Evaluation takes O(log n) for n waypoints, and O(1) for the other shapes. The unit of
/// the value depends on the use.
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
  /// Pairs (t [s], value) with strictly increasing times. The function is constant before the first and after the last
  /// pair. With the interpolation `cosine`, its rate is zero at the start and at the end of each segment.
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
  /// Returns the time derivative at t [unit of the value / s]; at a waypoint, the derivative of the segment that
  /// begins there.
  double rate(double t) const noexcept;
  const Shape& shape() const { return shape_; }
  bool is_constant() const { return std::holds_alternative<Constant>(shape_); }

 private:
  Shape shape_{Constant{}};
};

/// Returns the three profiles' values at t [s] as a vector, in their common unit.
inline Vec3 vector_at(const std::array<Profile, 3>& profiles, double t) noexcept {
  return {profiles[0](t), profiles[1](t), profiles[2](t)};
}

/// Scripted part of the tool's motion: always the orientation, and also the position if it is prescribed.
class Motion {
 public:
  virtual ~Motion() = default;
  /// Returns the tool's axis at time t [s]: a unit vector out of the tip.
  virtual Vec3 axis_at(double t) const noexcept = 0;
  /// Returns ToolPose::roll at time t [s], in rad. Called only if something reads the roll.
  virtual double roll_at(double /*t*/) const noexcept { return 0.0; }
  /// Returns true if the script rotates the tool about its axis. If false, the angular velocity of a solid of
  /// revolution leaves out the rotation about its axis. The angular velocity of any other tool contains it in both
  /// cases.
  virtual bool scripts_roll() const noexcept { return false; }
  /// Returns false if position_at() prescribes the tip centre, and true otherwise.
  virtual bool position_is_free() const noexcept { return true; }
  /// Returns the tip centre at time t [s], in m. Called only if the position is prescribed.
  virtual Vec3 position_at(double /*t*/) const noexcept { return Vec3::Zero(); }
};

/// Orientation of the tool as three angles over time. The tool is tilted by `tilt` from `up` towards lean', which
/// is `lean` rotated by `azimuth` about `up`: axis = -(cos(tilt) up + sin(tilt) lean'). At tilt 0 the tip points
/// down. If all three angles are 0, the tool's own x axis points along `lean` and its z axis along `up`. `roll`
/// rotates the tool about its axis.
struct Orientation {
  Vec3 up = {0.0, 0.0, 1.0};    ///< unit vector
  Vec3 lean = {1.0, 0.0, 0.0};  ///< unit vector, perpendicular to up
  Profile tilt;                 ///< [rad]
  Profile azimuth;              ///< [rad], right-handed about the vector `up`
  Profile roll = {};            ///< [rad], right-handed about the axis
};

/// Returns the tool's axis at the given angles [rad]; the orientation's own profiles are not evaluated.
Vec3 tool_axis(const Orientation& orientation, double tilt, double azimuth) noexcept;
/// Returns ToolPose::roll at the given angles [rad]; the orientation's own profiles are not evaluated.
double tool_roll(const Orientation& orientation, double tilt, double azimuth, double roll) noexcept;

/// Motion with the orientation given by profiles. The position is free, or given by three profiles x, y, z [m].
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
  std::optional<Vec3> constant_axis_;  ///< set if tilt and azimuth are constant
  std::optional<std::array<Profile, 3>> position_;
};

/// Playback of a recorded motion: linear interpolation between samples, constant before the first and after the
/// last. Orientations are interpolated at constant angular velocity along the shorter arc (slerp). If the samples have
/// no orientations, their axes are interpolated linearly and normalised, and the roll is 0.
class RecordedMotion final : public Motion {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 position = Vec3::Zero();
    /// Unit vector along the tool's axis, out of the tip. If `orientation` is set, it determines the axis.
    Vec3 axis = {0.0, 0.0, -1.0};
    /// Rotation from the tool frame to the world frame, a unit quaternion. Either all samples have an orientation
    /// or none.
    std::optional<Eigen::Quaterniond> orientation = {};
  };

  /// Throws std::invalid_argument if there is no sample, the times do not increase strictly, or only some samples
  /// have an orientation.
  explicit RecordedMotion(std::vector<Sample> samples);

  std::span<const Sample> samples() const { return samples_; }
  Vec3 axis_at(double t) const noexcept override;
  double roll_at(double t) const noexcept override;
  bool scripts_roll() const noexcept override { return samples_.front().orientation.has_value(); }
  bool position_is_free() const noexcept override { return false; }
  Vec3 position_at(double t) const noexcept override;

 private:
  struct Segment {
    const Sample* from;
    const Sample* to;
    /// Elapsed part of the segment, 0 to 1.
    double fraction;
  };
  Segment segment_at(double t) const noexcept;
  static Eigen::Quaterniond orientation_in(const Segment& leg) noexcept;

  std::vector<Sample> samples_;
};

}  // namespace hapbench
