#include "device_model/live/live_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "device_model/admittance_device.hpp"
#include "sim/core/floating_point_mode.hpp"
#include "sim/tool/orientation.hpp"

namespace hapbench {
namespace {

constexpr int kCallsBeforeForce = 4;  ///< number of successive calls below engage_force before the force rises
constexpr std::uint32_t kKnownBits = HAPBENCH_VELOCITY | HAPBENCH_ANGULAR_VELOCITY | HAPBENCH_HAND_FORCE |
                                     HAPBENCH_APPLIED_FORCE | HAPBENCH_CLUTCH | HAPBENCH_REARM;
constexpr double kNormTolerance = 1e-3;  ///< largest allowed difference between the norm of a quaternion and 1

Vec3 vector_of(const double (&v)[3]) noexcept {
  return {v[0], v[1], v[2]};
}

void write(double (&to)[3], const Vec3& v) noexcept {
  std::copy_n(v.data(), 3, to);
}

bool all_finite(const double* numbers, int n) noexcept {
  return std::all_of(numbers, numbers + n, [](double number) { return std::isfinite(number); });
}

double norm_of(const double (&wxyz)[4]) noexcept {
  return std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
}

const char* text_of(std::uint32_t reason) noexcept {
  switch (reason) {
    case HAPBENCH_NOT_FINITE:
      return "a number of the input is not finite";
    case HAPBENCH_BAD_ORIENTATION:
      return "the norm of the handle's orientation differs from 1 by more than 0.001";
    case HAPBENCH_BAD_TIME:
      return "time_ns is not later than in the previous call";
    case HAPBENCH_BAD_BITS:
      return "the input has an unknown bit, or a reserved field that is not 0";
    case HAPBENCH_NO_VELOCITY:
      return "the velocity is not given, and the scenario has no device.velocity_filter that computes it";
    case HAPBENCH_NO_HAND_FORCE:
      return "the hand's force, which moves the virtual mass, is not given";
    default:
      return "";
  }
}

}  // namespace

MountRotation::MountRotation(const double (&wxyz)[4])
    : quaternion_(Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized()),
      matrix_(quaternion_.toRotationMatrix()),
      is_identity_(wxyz[1] == 0.0 && wxyz[2] == 0.0 && wxyz[3] == 0.0) {}

LiveRenderer::LiveRenderer(const LiveRendererConfig& config, SimulationConfig simulation, SimulationParts parts)
    : config_(config),
      loop_(std::move(simulation), std::move(parts), config.is_admittance),
      velocity_filter_(config.velocity_filter.value_or(DifferenceFilter{}), loop_.dt()),
      world_(config.mount.world_from_device.orientation),
      tip_rotation_(config.mount.handle_from_tip.orientation),
      scale_(config.mount.scale),
      origin_(vector_of(config.mount.world_from_device.position)),
      tip_(vector_of(config.mount.handle_from_tip.position)) {
  if (config_.position_filter) position_filter_.emplace(*config_.position_filter, loop_.dt());
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the checks of a call, in the documented order.
void LiveRenderer::step(const HapbenchInput& input, HapbenchOutput& output) noexcept {
  const FloatingPointMode mode;
  output = {};
  output.call = calls_++;
  // Measure the time since the previous call. If the clock has not advanced, one period counts as elapsed, so that a
  // force that is being reduced to 0 is reduced further.
  const bool time_is_valid = !has_time_ || input.time_ns > last_time_;
  if (has_time_ && time_is_valid) output.dt = static_cast<double>(input.time_ns - last_time_) / 1e9;
  const double elapsed = time_is_valid && has_time_ ? output.dt : loop_.dt();
  const std::uint32_t problem = time_is_valid ? problem_of(input) : std::uint32_t{HAPBENCH_BAD_TIME};
  last_time_ = input.time_ns;
  has_time_ = true;
  const bool rearmed = (input.has & HAPBENCH_REARM) != 0 && (last_bits_ & HAPBENCH_REARM) == 0;
  last_bits_ = input.has;
  // End a fault, begin a fault, or react to a call that comes later than stale_s after the previous call. Then decide
  // whether this call renders.
  if (reason_ != HAPBENCH_NO_FAULT && rearmed && problem == HAPBENCH_NO_FAULT) {
    reason_ = HAPBENCH_NO_FAULT;
    release_ = release_gain_ > 0.0 ? Release::rearm : Release::none;
    restart();
  }
  if (problem != HAPBENCH_NO_FAULT && reason_ == HAPBENCH_NO_FAULT) fail(problem);
  if (reason_ == HAPBENCH_NO_FAULT && output.dt > config_.mount.stale_s) {
    if (release_ == Release::none && gain_ > 0.0) release(Release::stale);
    if (release_ == Release::none) restart();
  }
  if (reason_ != HAPBENCH_NO_FAULT) {
    takes_rest(elapsed, output);
    return;
  }
  const Measurement now = measured(input.handle);
  handle_clutch(now, (input.has & HAPBENCH_CLUTCH) != 0);
  if (!takes_rest(elapsed, output)) render(now, input, elapsed, output);
  last_measurement_ = now;
}

/// Returns the reason why a measurement cannot be rendered; HAPBENCH_NO_FAULT if it can. Vectors that are not given are
/// not read.
std::uint32_t LiveRenderer::problem_of(const HapbenchInput& input) const noexcept {
  if ((input.has & ~kKnownBits) != 0 || input.reserved != 0) return HAPBENCH_BAD_BITS;
  const std::pair<std::uint32_t, const double*> given[] = {{HAPBENCH_VELOCITY, input.velocity},
                                                           {HAPBENCH_ANGULAR_VELOCITY, input.angular_velocity},
                                                           {HAPBENCH_HAND_FORCE, input.hand_force},
                                                           {HAPBENCH_APPLIED_FORCE, input.applied_force}};
  bool finite = all_finite(input.handle.position, 3) && all_finite(input.handle.orientation, 4);
  for (const auto& [bit, vector] : given) finite = finite && ((input.has & bit) == 0 || all_finite(vector, 3));
  if (!finite) return HAPBENCH_NOT_FINITE;
  if (!(std::abs(norm_of(input.handle.orientation) - 1.0) <= kNormTolerance)) return HAPBENCH_BAD_ORIENTATION;
  if (config_.is_admittance) return (input.has & HAPBENCH_HAND_FORCE) != 0 ? HAPBENCH_NO_FAULT : HAPBENCH_NO_HAND_FORCE;
  return (input.has & HAPBENCH_VELOCITY) != 0 || config_.velocity_filter ? HAPBENCH_NO_FAULT : HAPBENCH_NO_VELOCITY;
}

LiveRenderer::Measurement LiveRenderer::measured(const HapbenchPose3& handle) const noexcept {
  const MountRotation rotation(handle.orientation);
  Measurement now;
  now.arm = rotation.turned(tip_);
  now.tip = tip_.isZero(0.0) ? vector_of(handle.position) : Vec3(vector_of(handle.position) + now.arm);
  now.orientation = rotation.quaternion();
  if (!tip_rotation_.is_identity()) now.orientation = now.orientation * tip_rotation_.quaternion();
  if (!world_.is_identity()) now.orientation = world_.quaternion() * now.orientation;
  if (loop_.tool_rolls() || loop_.needs_angular_velocity()) now.roll = roll_of(now.orientation);
  return now;
}

/// Returns the angular velocity of the handle in the device frame [rad/s]: the given value, or the turn since the
/// previous call divided by the period. Returns zero if neither exists.
Vec3 LiveRenderer::angular_velocity_of(const Measurement& now, const HapbenchInput& input) const noexcept {
  if ((input.has & HAPBENCH_ANGULAR_VELOCITY) != 0) return vector_of(input.angular_velocity);
  if (!has_tool_) return Vec3::Zero();
  const ToolPose before{Vec3::Zero(), axis_of(last_measurement_.orientation), roll_of(last_measurement_.orientation)};
  const ToolPose pose{Vec3::Zero(), axis_of(now.orientation), roll_of(now.orientation)};
  return world_.turned_back(turn(before, pose)) / loop_.dt();
}

/// Sets axis, roll and angular velocity of the tool.
void LiveRenderer::set_orientation(const Measurement& now, const HapbenchInput& input) noexcept {
  const Vec3 axis = axis_of(now.orientation);
  if (loop_.needs_angular_velocity()) {
    if ((input.has & HAPBENCH_ANGULAR_VELOCITY) != 0) {
      tool_.angular_velocity = world_.turned(vector_of(input.angular_velocity));
    } else if (has_tool_) {
      const ToolPose before{Vec3::Zero(), tool_.pose.axis, last_measurement_.roll};
      tool_.angular_velocity = loop_.angular_velocity(tool_.angular_velocity, before, {Vec3::Zero(), axis, now.roll});
    }
  }
  tool_.pose.axis = axis;
  if (loop_.tool_rolls()) tool_.pose.roll = now.roll;
}

/// Sets the tool's position to the measured position of the tip, filtered if the device has a position filter.
/// Sets the tool's velocity to the given velocity, or to the estimate of the velocity filter.
void LiveRenderer::follow_handle(const Measurement& now, const HapbenchInput& input) noexcept {
  Vec3 position = now.tip, velocity = Vec3::Zero();
  if (has_tool_)
    velocity = velocity_filter_.read(position);
  else
    velocity_filter_.reset(position);
  if ((input.has & HAPBENCH_VELOCITY) != 0) {
    velocity = vector_of(input.velocity);
    if (!tip_.isZero(0.0)) velocity += angular_velocity_of(now, input).cross(now.arm);
  }
  if (position_filter_ && has_tool_)
    position = position_filter_->filter(position);
  else if (position_filter_)
    position_filter_->settle_at(position);
  tool_.pose.position = to_world(position);
  tool_.velocity = scale_ * world_.turned(velocity);
}

/// Keeps the position of the tool while the clutch is pressed, and moves the mount when the clutch is released.
void LiveRenderer::handle_clutch(const Measurement& now, bool pressed) noexcept {
  if (pressed && !is_clutched_) {
    kept_position_ = has_position_ ? tool_.pose.position : to_world(now.tip);
    if (gain_ > 0.0 && release_ == Release::none) release(Release::clutch);
  } else if (!pressed && is_clutched_) {
    // In admittance mode, the virtual mass moved the handle while the clutch was pressed: continue from its position.
    const Vec3 at = config_.is_admittance && has_tool_ ? tool_.pose.position : to_world(now.tip);
    origin_ += *kept_position_ - at;
    tool_.pose.position = *kept_position_;
    const bool keeps_mass = config_.is_admittance && has_tool_;
    restart();
    has_tool_ = keeps_mass;
  }
  is_clutched_ = pressed;
}

/// While the force of an earlier call falls to 0 or a fault exists, writes the falling force (finally 0) and returns
/// true. Otherwise writes nothing and returns false; the call must then render.
bool LiveRenderer::takes_rest(double elapsed, HapbenchOutput& output) noexcept {
  if (release_ == Release::none && reason_ == HAPBENCH_NO_FAULT) return false;
  const double ramp = config_.mount.ramp_s;
  release_gain_ = ramp > 0.0 ? std::max(0.0, release_gain_ - elapsed / ramp) : 0.0;
  last_force_ = release_gain_ * held_force_;
  output.gain = release_gain_ * held_gain_;
  output.reason = reason_;
  output.status = reason_ != HAPBENCH_NO_FAULT ? HAPBENCH_FAULT
                  : release_ == Release::stale ? HAPBENCH_STALE
                                               : HAPBENCH_RAMPING;
  write(output.force, last_force_);
  if (config_.is_admittance) write(output.set_position, set_position_);
  if (release_gain_ == 0.0 && reason_ == HAPBENCH_NO_FAULT) {
    const bool was_stale = release_ == Release::stale;
    release_ = Release::none;
    if (was_stale) restart();
  }
  return true;
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the phases of a call, in the documented order.
void LiveRenderer::render(const Measurement& now, const HapbenchInput& input, double elapsed,
                          HapbenchOutput& output) noexcept {
  // Set the pose and velocity of the tool. A virtual mass starts at rest at the measured position.
  set_orientation(now, input);
  if (!config_.is_admittance) {
    follow_handle(now, input);
  } else if (!has_tool_) {
    tool_.pose.position = to_world(now.tip);
    tool_.velocity.setZero();
  }
  // In admittance mode, limit the hand's force. Render the force; in impedance mode, only while the clutch is released.
  Vec3 hand = Vec3::Zero();
  if (config_.is_admittance) {
    hand = world_.turned(vector_of(input.hand_force));
    const Vec3 limited = limit_input_force(hand, config_.input_force_limit);
    if (limited != hand) output.limited |= HAPBENCH_INPUT_FORCE_LIMIT;
    hand = limited;
  }
  if (!is_clutched_ || config_.is_admittance) {
    if (!loop_.render(tool_, hand)) {
      fail(loop_.fault() != nullptr ? HAPBENCH_ALGORITHM_FAILED : HAPBENCH_OUT_OF_BOUNDS);
      takes_rest(elapsed, output);
      return;
    }
  }
  // Compute the factor on the rendered force, `gain_`.
  const Vec3& rendered = loop_.force().rendered;
  const HapbenchMount& mount = config_.mount;
  if (is_clutched_) {
    gain_ = 0.0;
    calls_below_ = 0;
  } else if (calls_below_ >= kCallsBeforeForce) {
    gain_ = mount.ramp_s > 0.0 ? std::min(1.0, gain_ + std::min(elapsed, mount.stale_s) / mount.ramp_s) : 1.0;
  } else {
    calls_below_ = rendered.norm() < mount.engage_force ? calls_below_ + 1 : 0;
  }
  output.status = gain_ == 0.0 ? HAPBENCH_WAITING : gain_ < 1.0 ? HAPBENCH_RAMPING : HAPBENCH_ON;
  output.gain = gain_;
  if (!is_clutched_) output.contacts = static_cast<std::uint32_t>(loop_.contacts());
  // Report the force and the moment.
  Vec3 force = gain_ > 0.0 ? world_.turned_back(gain_ * rendered) : Vec3::Zero();
  if (config_.wants_torque && gain_ > 0.0) {
    const Vec3 moment = world_.turned_back(gain_ * loop_.moment(tool_)) / scale_;
    write(output.torque, moment + now.arm.cross(force));
  }
  if (!config_.is_admittance) limit(force, elapsed, output);
  write(output.force, force);
  last_force_ = force;
  if (config_.is_admittance) {
    loop_.move(tool_, gain_);
    report_set_point(now, input, output);
  }
  has_tool_ = has_position_ = true;
}

/// Limits the norm of the force and of its rate of change.
void LiveRenderer::limit(Vec3& force, double elapsed, HapbenchOutput& output) const noexcept {
  const HapbenchMount& mount = config_.mount;
  if (const double norm = force.norm(); norm > mount.max_force) {
    force *= mount.max_force / norm;
    output.limited |= HAPBENCH_MAX_FORCE;
  }
  const Vec3 change = force - last_force_;
  const double largest = mount.max_force_rate * std::min(elapsed, mount.stale_s);
  if (const double norm = change.norm(); norm > largest) {
    force = last_force_ + change * (largest / norm);
    output.limited |= HAPBENCH_MAX_FORCE_RATE;
  }
  if (output.limited != 0 && output.status == HAPBENCH_ON) output.status = HAPBENCH_CLAMPED;
}

void LiveRenderer::report_set_point(const Measurement& now, const HapbenchInput& input,
                                    HapbenchOutput& output) noexcept {
  const Vec3 tip = world_.turned_back(tool_.pose.position - origin_) / scale_;
  Vec3 velocity = world_.turned_back(tool_.velocity) / scale_;
  set_position_ = tip;
  if (!tip_.isZero(0.0)) {
    set_position_ -= now.arm;
    velocity -= angular_velocity_of(now, input).cross(now.arm);
  }
  write(output.set_position, set_position_);
  write(output.set_velocity, velocity);
  if (output.limited != 0 && output.status == HAPBENCH_ON) output.status = HAPBENCH_CLAMPED;
}

/// Restarts the loop: the status is WAITING until kCallsBeforeForce successive rendered forces are below engage_force.
/// Keeps mount and clutch.
void LiveRenderer::restart() noexcept {
  loop_.reset();
  gain_ = 0.0;
  calls_below_ = 0;
  has_tool_ = false;
  tool_.angular_velocity.setZero();
}

/// Starts to reduce the force of the last call to 0, for the reason `why`.
void LiveRenderer::release(Release why) noexcept {
  release_ = why;
  release_gain_ = gain_ > 0.0 ? 1.0 : 0.0;
  held_force_ = last_force_;
  held_gain_ = gain_;
  gain_ = 0.0;
  calls_below_ = 0;
}

void LiveRenderer::fail(std::uint32_t reason) noexcept {
  if (release_ == Release::none) release(Release::fault);
  release_ = Release::fault;
  reason_ = reason;
  is_clutched_ = has_position_ = false;
  // Use the text of a module that failed, or name the quantity that is out of bounds.
  if (reason == HAPBENCH_ALGORITHM_FAILED)
    std::snprintf(fault_text_.data(), fault_text_.size(), "%s", loop_.fault());
  else if (reason == HAPBENCH_OUT_OF_BOUNDS)
    std::snprintf(fault_text_.data(), fault_text_.size(), "the %s is not finite or beyond the scenario's bound",
                  loop_.out_of_bounds());
  else
    std::snprintf(fault_text_.data(), fault_text_.size(), "%s", text_of(reason));
}

}  // namespace hapbench
