#include "sim/tool/motion.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/core/math.hpp"
#include "sim/tool/tool_state.hpp"

namespace hapbench {

namespace {

/// The axis reversed, and the lean, turned as `up` is to it.
struct Leaning {
  Vec3 up, side;
};

Leaning leaning(const Orientation& orientation, double tilt, double azimuth) noexcept {
  const auto [around, onward] = math::sine_cosine(azimuth);
  const auto [sine, cosine] = math::sine_cosine(tilt);
  const Vec3 lean = onward * orientation.lean + around * orientation.up.cross(orientation.lean);
  return {cosine * orientation.up + sine * lean, cosine * lean - sine * orientation.up};
}

}  // namespace

Vec3 tool_axis(const Orientation& orientation, double tilt, double azimuth) noexcept {
  return -leaning(orientation, tilt, azimuth).up;
}

double tool_roll(const Orientation& orientation, double tilt, double azimuth, double roll) noexcept {
  const auto [up, side] = leaning(orientation, tilt, azimuth);
  return roll_towards(-up, side) + roll;
}

static Vec3 axis_of(const Eigen::Quaterniond& orientation) noexcept {
  return (orientation * -Vec3::UnitZ()).normalized();
}

ScriptedMotion::ScriptedMotion(Orientation orientation, std::optional<std::array<Profile, 3>> position)
    : orientation_(std::move(orientation)), position_(std::move(position)) {
  if (orientation_.tilt.is_constant() && orientation_.azimuth.is_constant()) {
    held_axis_ = tool_axis(orientation_, orientation_.tilt(0.0), orientation_.azimuth(0.0));
  }
}

Vec3 ScriptedMotion::axis_at(double t) const noexcept {
  if (held_axis_) return *held_axis_;
  return tool_axis(orientation_, orientation_.tilt(t), orientation_.azimuth(t));
}

double ScriptedMotion::roll_at(double t) const noexcept {
  return tool_roll(orientation_, orientation_.tilt(t), orientation_.azimuth(t), orientation_.roll(t));
}

Vec3 ScriptedMotion::position_at(double t) const noexcept {
  const auto& profiles = *position_;
  return {profiles[0](t), profiles[1](t), profiles[2](t)};
}

RecordedMotion::RecordedMotion(std::vector<Sample> samples) : samples_(std::move(samples)) {
  if (samples_.empty()) throw std::invalid_argument("a recorded motion needs at least one sample");
  for (Sample& sample : samples_) {
    if (sample.orientation) sample.axis = axis_of(*sample.orientation);
  }
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    if (!(samples_[i - 1].time < samples_[i].time)) {
      throw std::invalid_argument("the times of a recorded motion must increase strictly");
    }
    if (samples_[i].orientation.has_value() != samples_[0].orientation.has_value()) {
      throw std::invalid_argument("either all samples of a recorded motion have an orientation or none has");
    }
  }
}

RecordedMotion::Leg RecordedMotion::leg_at(double t) const noexcept {
  const auto next = std::upper_bound(samples_.begin(), samples_.end(), t,
                                     [](double time, const Sample& sample) { return time < sample.time; });
  if (next == samples_.begin()) return {&samples_.front(), &samples_.front(), 0.0};
  if (next == samples_.end()) return {&samples_.back(), &samples_.back(), 0.0};
  const Sample& from = *(next - 1);
  return {&from, &*next, (t - from.time) / (next->time - from.time)};
}

Eigen::Quaterniond RecordedMotion::orientation_in(const Leg& leg) noexcept {
  const Eigen::Quaterniond turn = leg.from->orientation->conjugate() * *leg.to->orientation;
  const double sine = turn.vec().norm();  // of half the angle
  if (sine == 0.0) return *leg.from->orientation;
  return *leg.from->orientation * turn_about(turn.vec() / sine, leg.fraction * angle_of(turn, sine));
}

Vec3 RecordedMotion::axis_at(double t) const noexcept {
  const Leg leg = leg_at(t);
  if (leg.from->orientation) return axis_of(orientation_in(leg));
  const Vec3 axis = leg.from->axis + leg.fraction * (leg.to->axis - leg.from->axis);
  // Opposite neighbours pass through zero half-way; keeps the last direction there.
  return unit_or(axis, leg.from->axis);
}

double RecordedMotion::roll_at(double t) const noexcept {
  const Leg leg = leg_at(t);
  if (!leg.from->orientation) return 0.0;
  const Eigen::Quaterniond q = orientation_in(leg);
  return roll_towards(axis_of(q), q * Vec3::UnitX());
}

Vec3 RecordedMotion::position_at(double t) const noexcept {
  const Leg leg = leg_at(t);
  return leg.from->position + leg.fraction * (leg.to->position - leg.from->position);
}

}  // namespace hapbench
