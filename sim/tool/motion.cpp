#include "sim/tool/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/tool/orientation.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {
namespace {

/// Returns the right-handed rotation about a unit axis by an angle [rad].
Eigen::Quaterniond turn_about(const Vec3& axis, double angle) noexcept {
  const auto [sine, cosine] = math::sine_cosine(0.5 * angle);
  Eigen::Quaterniond q;
  q.w() = cosine;
  q.vec() = sine * axis;
  return q;
}

/// Returns the rotation angle of a unit quaternion in (-pi, pi] about q.vec(). `sine` is the length of q.vec(),
/// which must be > 0.
double angle_of(const Eigen::Quaterniond& q, double sine) noexcept {
  return 2.0 * math::atan2(q.w() < 0.0 ? -sine : sine, std::abs(q.w()));
}

/// Returns the matrix of the shortest rotation from -z to a unit vector, by Rodrigues' formula I + [v] + [v]^2 (1 -
/// c) / |v|^2. v = -z x axis is the rotation axis times the sine of the angle, c = <-z, axis> the cosine.
Mat3 shortest_turn(const Vec3& axis) noexcept {
  const Vec3 v(axis.y(), -axis.x(), 0.0);
  const double sine2 = v.squaredNorm(), cosine = -axis.z();
  if (sine2 == 0.0) return cosine > 0.0 ? Mat3(Mat3::Identity()) : Mat3(Vec3(1.0, -1.0, -1.0).asDiagonal());
  Mat3 cross;
  cross << 0.0, 0.0, v.y(), 0.0, 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return Mat3::Identity() + cross + (1.0 - cosine) / sine2 * cross * cross;
}

/// Segment between two waypoints: value at its start, change of the value, and duration [s].
struct Segment {
  double start, rise, duration;
  double fraction;  ///< elapsed part of the duration, 0 to 1
};

/// Returns the segment at time t. Before the first and after the last waypoint, this is a segment with a constant
/// value.
Segment segment_at(const Profile::Waypoints& w, double t) {
  const auto& p = w.points;
  if (p.empty()) return {0.0, 0.0, 1.0, 0.0};
  if (!(t >= p.front().first)) return {p.front().second, 0.0, 1.0, 0.0};
  if (t >= p.back().first) return {p.back().second, 0.0, 1.0, 0.0};
  const auto next = std::upper_bound(p.begin(), p.end(), t, [](double time, const auto& q) { return time < q.first; });
  const auto last = next - 1;
  const double duration = next->first - last->first;
  return {last->second, next->second - last->second, duration, (t - last->first) / duration};
}

/// Unit vectors of the tilted tool: `up` is the reversed tool axis. `side` is perpendicular to it: the direction in
/// which the tool leans, tilted by the same angle.
struct TiltedFrame {
  Vec3 up, side;
};

/// Returns the frame at the given tilt and azimuth [rad].
TiltedFrame tilted_frame(const Orientation& orientation, double tilt, double azimuth) noexcept {
  const auto [around, onward] = math::sine_cosine(azimuth);
  const auto [sine, cosine] = math::sine_cosine(tilt);
  const Vec3 lean = onward * orientation.lean + around * orientation.up.cross(orientation.lean);
  return {cosine * orientation.up + sine * lean, cosine * lean - sine * orientation.up};
}

}  // namespace

Vec3 axis_of(const Eigen::Quaterniond& orientation) noexcept {
  return (orientation * -Vec3::UnitZ()).normalized();
}

double roll_of(const Eigen::Quaterniond& orientation) noexcept {
  return roll_towards(axis_of(orientation), orientation * Vec3::UnitX());
}

Mat3 ToolPose::rotation() const noexcept {
  return turn_about(axis, roll).toRotationMatrix() * shortest_turn(axis);
}

double roll_towards(const Vec3& axis, const Vec3& side) noexcept {
  const Vec3 x = shortest_turn(axis).col(0);
  return math::atan2(axis.cross(x).dot(side), x.dot(side));
}

Mat3 turn_matrix(const ToolPose& from, const ToolPose& to) noexcept {
  const Vec3 v = from.axis.cross(to.axis);
  const double cosine = from.axis.dot(to.axis);
  Mat3 cross;
  cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  Mat3 turn = Mat3::Identity() + cross + cross * cross / (1.0 + cosine);
  if (v.squaredNorm() == 0.0 && cosine < 0.0) {  // opposite axes: 180 degrees about any perpendicular axis
    const Vec3 across = from.axis.unitOrthogonal();
    turn = 2.0 * across * across.transpose() - Mat3::Identity();
  }
  if (to.roll == from.roll) return turn;
  return turn_about(to.axis, to.roll - from.roll).toRotationMatrix() * turn;
}

Vec3 turn(const ToolPose& from, const ToolPose& to) noexcept {
  if (from.roll == 0.0 && to.roll == 0.0) return turn(from.axis, to.axis);
  const Eigen::Quaterniond whole(Mat3(to.rotation() * from.rotation().transpose()));
  const double sine = whole.vec().norm();  // sine of half the angle
  if (sine == 0.0) return Vec3::Zero();
  return whole.vec() * (angle_of(whole, sine) / sine);
}

double Profile::Sine::at(double t) const noexcept {
  return mean + amplitude * math::sin(2.0 * std::numbers::pi * t / period_s + phase_rad);
}

double Profile::Sine::rate(double t) const noexcept {
  const double omega = 2.0 * std::numbers::pi / period_s;
  return amplitude * omega * math::cos(omega * t + phase_rad);
}

double Profile::Waypoints::at(double t) const noexcept {
  const Segment segment = segment_at(*this, t);
  if (segment.rise == 0.0) return segment.start;
  if (interpolation == Interpolation::linear) return segment.start + segment.fraction * segment.rise;
  return segment.start + (0.5 - 0.5 * math::cos(std::numbers::pi * segment.fraction)) * segment.rise;
}

double Profile::Waypoints::rate(double t) const noexcept {
  const Segment segment = segment_at(*this, t);
  if (segment.rise == 0.0) return 0.0;
  if (interpolation == Interpolation::linear) return segment.rise / segment.duration;
  return 0.5 * std::numbers::pi * math::sin(std::numbers::pi * segment.fraction) * segment.rise / segment.duration;
}

double Profile::operator()(double t) const noexcept {
  return std::visit([t](const auto& shape) { return shape.at(t); }, shape_);
}

double Profile::rate(double t) const noexcept {
  return std::visit([t](const auto& shape) { return shape.rate(t); }, shape_);
}

Vec3 tool_axis(const Orientation& orientation, double tilt, double azimuth) noexcept {
  return -tilted_frame(orientation, tilt, azimuth).up;
}

double tool_roll(const Orientation& orientation, double tilt, double azimuth, double roll) noexcept {
  const auto [up, side] = tilted_frame(orientation, tilt, azimuth);
  return roll_towards(-up, side) + roll;
}

ScriptedMotion::ScriptedMotion(Orientation orientation, std::optional<std::array<Profile, 3>> position)
    : orientation_(std::move(orientation)), position_(std::move(position)) {
  if (orientation_.tilt.is_constant() && orientation_.azimuth.is_constant()) {
    constant_axis_ = tool_axis(orientation_, orientation_.tilt(0.0), orientation_.azimuth(0.0));
  }
}

Vec3 ScriptedMotion::axis_at(double t) const noexcept {
  if (constant_axis_) return *constant_axis_;
  return tool_axis(orientation_, orientation_.tilt(t), orientation_.azimuth(t));
}

double ScriptedMotion::roll_at(double t) const noexcept {
  return tool_roll(orientation_, orientation_.tilt(t), orientation_.azimuth(t), orientation_.roll(t));
}

Vec3 ScriptedMotion::position_at(double t) const noexcept {
  return vector_at(*position_, t);
}

RecordedMotion::RecordedMotion(std::vector<Sample> samples) : samples_(std::move(samples)) {
  if (samples_.empty()) refuse("a recorded motion needs at least one sample");
  for (Sample& sample : samples_) {
    if (sample.orientation) sample.axis = axis_of(*sample.orientation);
  }
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    if (!(samples_[i - 1].time < samples_[i].time)) refuse("the times of a recorded motion must increase strictly");
    if (samples_[i].orientation.has_value() != samples_[0].orientation.has_value())
      refuse("either all samples of a recorded motion have an orientation or none has");
  }
}

RecordedMotion::Segment RecordedMotion::segment_at(double t) const noexcept {
  const auto next = std::ranges::upper_bound(samples_, t, {}, &Sample::time);
  if (next == samples_.begin()) return {&samples_.front(), &samples_.front(), 0.0};
  if (next == samples_.end()) return {&samples_.back(), &samples_.back(), 0.0};
  const Sample& from = *(next - 1);
  return {&from, &*next, (t - from.time) / (next->time - from.time)};
}

Eigen::Quaterniond RecordedMotion::orientation_in(const Segment& segment) noexcept {
  const Eigen::Quaterniond turn = segment.from->orientation->conjugate() * *segment.to->orientation;
  const double sine = turn.vec().norm();  // sine of half the rotation angle
  if (sine == 0.0) return *segment.from->orientation;
  return *segment.from->orientation * turn_about(turn.vec() / sine, segment.fraction * angle_of(turn, sine));
}

Vec3 RecordedMotion::axis_at(double t) const noexcept {
  const Segment segment = segment_at(t);
  if (segment.from->orientation) return axis_of(orientation_in(segment));
  const Vec3 axis = segment.from->axis + segment.fraction * (segment.to->axis - segment.from->axis);
  // If the axes of the two samples are opposite, the interpolated vector may be zero; then return the axis of the
  // earlier sample.
  return unit_or(axis, segment.from->axis);
}

double RecordedMotion::roll_at(double t) const noexcept {
  const Segment segment = segment_at(t);
  return segment.from->orientation ? roll_of(orientation_in(segment)) : 0.0;
}

Vec3 RecordedMotion::position_at(double t) const noexcept {
  const Segment segment = segment_at(t);
  return segment.from->position + segment.fraction * (segment.to->position - segment.from->position);
}

}  // namespace hapbench
