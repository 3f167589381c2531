#include "sim/loop/simulation.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "sim/contact/index_hash.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

/// Computes the force between step k and step k + 1 for the integrator. Overwrites the contact buffer, because nothing
/// reads the buffer after the observers have been notified.
class Simulation::ForceWithinStep final : public ForceField {
 public:
  explicit ForceWithinStep(Simulation& simulation) : s_(simulation) {}

  Vec3 force_at(double fraction, const Vec3& position, const Vec3& velocity) noexcept override {
    const double t = (static_cast<double>(s_.row_) + fraction) * s_.config_.dt;
    const Vec3 axis = s_.parts_.motion->axis_at(t);
    const double roll = s_.roll_at(t);
    ToolState tool{{position, axis, s_.tool_rolls_ ? roll : 0.0}, velocity};
    if (s_.angular_velocity_cutoff_) tool.angular_velocity = s_.angular_velocity_after(fraction, axis, roll);
    s_.parts_.source->contacts_at(tool.pose, s_.contacts_);
    s_.parts_.algorithm->compute(tool, s_.contacts_, s_.within_step_);
    return s_.record_.hand.input + s_.within_step_.rendered;
  }
  std::uint64_t contact_set() const noexcept override { return index_hash(s_.contacts_); }
  ForceJacobian jacobian() const noexcept override { return s_.parts_.algorithm->jacobian(); }

 private:
  Simulation& s_;
};

Simulation::Simulation(SimulationConfig config, SimulationParts parts, std::vector<Observer*> observers)
    : config_(std::move(config)),
      parts_(std::move(parts)),
      observers_(std::move(observers)),
      contacts_(parts_.source->capacity()) {
  // Find out which optional quantities the observers read.
  ratio_wanted_ = springs_wanted_ = energy_wanted_ = config_.skips == Skips::off;
  for (const Observer* observer : observers_) {
    ratio_wanted_ |= observer->wants_ratio();
    springs_wanted_ |= observer->wants_springs();
    energy_wanted_ |= observer->wants_energy();
    roll_wanted_ |= observer->wants_roll();
    if (observer->wants_found() && !found_) found_ = std::make_unique<ContactBuffer>(contacts_.capacity());
  }
  // Find out what moves the tool and the handle, and whether the roll angle is needed.
  position_is_free_ = parts_.motion->position_is_free();
  handle_is_separate_ = parts_.device->energy().has_value();
  handle_moves_tool_ = position_is_free_ && parts_.device->moves_tool();
  angular_velocity_cutoff_ = parts_.algorithm->angular_velocity_cutoff();
  tool_rolls_ = parts_.tool && !parts_.tool->is_axisymmetric();
  turn_rolls_ = tool_rolls_ || parts_.motion->scripts_roll();
  roll_wanted_ |= tool_rolls_ || (turn_rolls_ && angular_velocity_cutoff_);
  // Give source and algorithm access to the current step, and prepare the algorithm.
  parts_.source->follow(&record_.step);
  parts_.algorithm->prepare({.capacity = parts_.source->capacity(),
                             .tool = parts_.tool.get(),
                             .shell = parts_.shell.get(),
                             .springs = parts_.springs.get(),
                             .dt = config_.dt,
                             .schedule = parts_.source->schedule(),
                             .row = &record_.step,
                             .input = &record_.hand.input,
                             .position_is_free = position_is_free_,
                             .handle_moves_tool = handle_moves_tool_});
  reset();
}

void Simulation::reset() noexcept {
  row_ = 0;
  ended_ = config_.steps == 0;
  result_ = {};
  record_ = {};
  record_.handle_moves_tool = handle_moves_tool_;
  record_.found = found_.get();
  tool_ = {{config_.position, Vec3::Zero()}, config_.velocity};
  parts_.hand->reset();  // first, because the hand may determine the orientation
  move_tool_by_script();
  parts_.source->reset();
  parts_.algorithm->reset();
  parts_.device->reset(tool_);
  if (handle_moves_tool_) put_tool_on_handle();
}

double Simulation::roll_at(double t) const noexcept {
  return roll_wanted_ ? parts_.motion->roll_at(t) : 0.0;
}

/// Returns the low-pass filtered angular velocity [rad/s] after a turn from the current step's orientation to the given
/// orientation in the time t = `fraction` dt. The first-order low-pass with cut-off frequency f weights the angular
/// velocity of this turn with 1 - e^(-2 pi f t), and the previous output with e^(-2 pi f t).
Vec3 Simulation::angular_velocity_after(double fraction, const Vec3& axis, double roll) const noexcept {
  const double time = fraction * config_.dt;
  const double taken = -math::expm1(-2.0 * std::numbers::pi * *angular_velocity_cutoff_ * time);
  const ToolPose from{Vec3::Zero(), tool_.pose.axis, turn_rolls_ ? roll_ : 0.0};
  const ToolPose to{Vec3::Zero(), axis, turn_rolls_ ? roll : 0.0};
  return (1.0 - taken) * tool_.angular_velocity + taken * turn(from, to) / time;
}

/// Moves the tool to its scripted pose at the current step k. The orientation always follows the script. If the
/// algorithm reads the angular velocity, omega_k is the low-pass filtered rotation from step k - 1 to step k divided by
/// dt, and omega_0 = 0. A prescribed position also gives the velocity, v_k = (p_k - p_{k-1}) / dt, and v_0 = v_1.
void Simulation::move_tool_by_script() noexcept {
  const double t = static_cast<double>(row_) * config_.dt;
  const Vec3 axis = parts_.motion->axis_at(t);
  const double roll = roll_at(t);
  if (angular_velocity_cutoff_ && row_ > 0) tool_.angular_velocity = angular_velocity_after(1.0, axis, roll);
  tool_.pose.axis = axis;
  // The pose of a solid of revolution omits the roll, so that no result depends on it.
  if (tool_rolls_) tool_.pose.roll = roll;
  roll_ = roll;
  if (position_is_free_) return;
  const Vec3 position = parts_.motion->position_at(t);
  const Vec3 displacement =
      row_ == 0 ? Vec3(parts_.motion->position_at(config_.dt) - position) : Vec3(position - tool_.pose.position);
  tool_.velocity = displacement / config_.dt;
  tool_.pose.position = position;
}

void Simulation::put_tool_on_handle() noexcept {
  const HandleState sampled = parts_.device->sampled();
  tool_.pose.position = sampled.position;
  tool_.velocity = sampled.velocity;
}

bool Simulation::step() noexcept {
  if (ended_) return false;
  StepRecord& r = record_;
  r.step = row_;
  r.time = static_cast<double>(row_) * config_.dt;
  r.tool = tool_;
  r.roll = roll_;

  // Read hand and device.
  const HandleState& handle = parts_.device->handle();
  r.hand_force = parts_.hand->force(r.time, {handle, tool_.pose, r.force.rendered, r.force.spring});
  r.handle = handle;
  r.task = parts_.hand->task();
  r.hand = parts_.device->measure(r.hand_force);

  // Find the contacts.
  parts_.source->contacts_at(tool_.pose, contacts_);
  if (parts_.source->fault() != nullptr) {
    result_.divergence = {row_, r.time, "contacts", std::nan(""), 0.0, parts_.source->fault()};
    end(Ending::diverged);
    return true;
  }
  if (found_) found_->assign(contacts_);
  r.colliding = contacts_.size();

  // Compute the rendered force.
  parts_.algorithm->compute(tool_, contacts_, r.force);
  if (!check_bounds()) return true;

  // Notify the observers. Optional quantities are computed only if an observer reads them.
  r.rendered = &contacts_;
  if (ratio_wanted_) r.ratio = ratio_range(contacts_, r.force.S);
  if (springs_wanted_) r.springs = {};
  if (springs_wanted_ && (has_springs(contacts_, r.force) || config_.skips == Skips::off))
    r.springs = parts_.algorithm->spring_state(tool_, contacts_);
  if (energy_wanted_) r.device = parts_.device->energy();
  for (Observer* observer : observers_) observer->on_step(r);
  ++result_.rows;
  if (check_stop_rules()) return true;

  // Move the tool with the forces of this step. If the handle moves the tool, move the handle and put the tool on it.
  // Otherwise integrate the motion of the virtual mass.
  if (handle_moves_tool_) {
    parts_.device->drive(r.force.rendered, r.hand_force);
    put_tool_on_handle();
  } else if (position_is_free_) {
    ForceWithinStep field(*this);
    config_.integrator->step(tool_, r.hand.input + r.force.rendered, config_.mass, config_.dt, field,
                             config_.event_tolerance);
  }

  // Begin the next step.
  ++row_;
  if (row_ == config_.steps) {
    end(Ending::completed);
    return true;
  }
  move_tool_by_script();
  if (!handle_moves_tool_) parts_.device->advance(tool_, r.hand_force, config_.dt);
  return true;
}

bool Simulation::advance(std::uint64_t steps) noexcept {
  while (steps > 0 && step()) --steps;
  return !ended_;
}

SimulationResult Simulation::run() noexcept {
  while (step()) {
  }
  return result_;
}

void Simulation::drop_observers() noexcept {
  observers_.clear();
  found_.reset();
  record_.found = nullptr;
  ratio_wanted_ = springs_wanted_ = energy_wanted_ = config_.skips == Skips::off;
}

bool Simulation::check_bounds() noexcept {
  const DivergenceBounds& bounds = config_.bounds;
  const auto all = [&](auto within, bool handle_too) {
    return within("position", tool_.pose.position, bounds.position) &&
           within("velocity", tool_.velocity, bounds.speed) &&
           within("rendered force", record_.force.rendered, bounds.force) &&
           (!handle_too || (within("handle position", record_.handle.position, bounds.position) &&
                            within("handle velocity", record_.handle.velocity, bounds.speed) &&
                            within("measured force", record_.hand.measured, bounds.force)));
  };
  // Nearly every step takes this fast path, which compares squares; NaN fails the comparison.
  const auto well_inside = [](const char*, const Vec3& v, double bound) {
    return v.squaredNorm() <= 0.5 * bound * bound;
  };
  if (all(well_inside, handle_is_separate_)) return true;
  // Find the quantity that exceeds its bound and report it.
  const auto inside = [this](const char* quantity, const Vec3& v, double bound) {
    const double magnitude = v.norm();
    if (magnitude <= bound) return true;  // false for NaN
    const char* fault = parts_.algorithm->fault();
    result_.divergence = {row_, record_.time, quantity, magnitude, bound, fault != nullptr ? fault : ""};
    return false;
  };
  if (all(inside, true)) return true;
  end(Ending::diverged);
  return false;
}

bool Simulation::check_stop_rules() noexcept {
  for (const StopRule& rule : config_.stop_when) {
    const bool holds =
        rule.ending == Ending::left_hole ? tool_.pose.position.dot(rule.up) > 0.0 : tool_.pose.axis.dot(rule.up) >= 0.0;
    if (!holds) continue;
    end(rule.ending);
    return true;
  }
  if (parts_.hand->finished()) end(Ending::completed);
  return ended_;
}

void Simulation::end(Ending ending) noexcept {
  ended_ = true;
  result_.ending = ending;
}

}  // namespace hapbench
