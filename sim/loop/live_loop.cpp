#include "sim/loop/live_loop.hpp"

#include <numbers>
#include <utility>

#include "sim/contact/index_hash.hpp"
#include "sim/core/math.hpp"

namespace hapbench {

/// Computes the force between two steps for the integrator, with the contacts at the given position. The tool keeps the
/// orientation of the current step.
class LiveLoop::ForceWithinStep final : public ForceField {
 public:
  ForceWithinStep(LiveLoop& loop, const ToolState& tool, double gain) : loop_(loop), tool_(tool), gain_(gain) {}

  Vec3 force_at(double, const Vec3& position, const Vec3& velocity) noexcept override {
    tool_.pose.position = position;
    tool_.velocity = velocity;
    loop_.parts_.source->contacts_at(tool_.pose, loop_.contacts_);
    loop_.parts_.algorithm->compute(tool_, loop_.contacts_, loop_.within_step_);
    return loop_.input_ + gain_ * loop_.within_step_.rendered;
  }
  std::uint64_t contact_set() const noexcept override { return index_hash(loop_.contacts_); }
  ForceJacobian jacobian() const noexcept override {
    const ForceJacobian full = loop_.parts_.algorithm->jacobian();
    return {gain_ * full.stiffness, gain_ * full.damping};
  }

 private:
  LiveLoop& loop_;
  ToolState tool_;
  double gain_;
};

LiveLoop::LiveLoop(SimulationConfig config, SimulationParts parts, bool has_virtual_mass)
    : config_(std::move(config)),
      parts_(std::move(parts)),
      contacts_(parts_.source->capacity()),
      tool_rolls_(parts_.tool && !parts_.tool->is_axisymmetric()),
      angular_velocity_cutoff_(parts_.algorithm->angular_velocity_cutoff()) {
  parts_.source->follow(&row_);
  parts_.algorithm->prepare({.capacity = parts_.source->capacity(),
                             .tool = parts_.tool.get(),
                             .shell = parts_.shell.get(),
                             .springs = parts_.springs.get(),
                             .dt = config_.dt,
                             .schedule = parts_.source->schedule(),
                             .row = &row_,
                             .input = &input_,
                             .position_is_free = true,
                             .handle_moves_tool = !has_virtual_mass});
  reset();
}

void LiveLoop::reset() noexcept {
  row_ = next_row_ = 0;
  force_ = {};
  parts_.source->reset();
  parts_.algorithm->reset();
}

bool LiveLoop::render(const ToolState& tool, const Vec3& input) noexcept {
  row_ = next_row_++;
  input_ = input;
  fault_ = out_of_bounds_ = nullptr;
  // Find the contacts and compute the force.
  parts_.source->contacts_at(tool.pose, contacts_);
  fault_ = parts_.source->fault();
  if (fault_ != nullptr) return false;
  parts_.algorithm->compute(tool, contacts_, force_);
  // Check the bounds. NaN fails the comparisons.
  const auto within = [&](const char* quantity, const Vec3& v, double bound) {
    if (v.norm() <= bound) return true;
    out_of_bounds_ = quantity;
    return false;
  };
  const DivergenceBounds& bounds = config_.bounds;
  if (within("position", tool.pose.position, bounds.position) && within("velocity", tool.velocity, bounds.speed) &&
      within("rendered force", force_.rendered, bounds.force))
    return true;
  fault_ = parts_.algorithm->fault();
  return false;
}

void LiveLoop::move(ToolState& tool, double gain) noexcept {
  ForceWithinStep field(*this, tool, gain);
  config_.integrator->step(tool, input_ + gain * force_.rendered, config_.mass, config_.dt, field,
                           config_.event_tolerance);
}

Vec3 LiveLoop::moment(const ToolState& tool) const noexcept {
  return has_springs(contacts_, force_) ? parts_.algorithm->spring_state(tool, contacts_).moment : Vec3::Zero();
}

Vec3 LiveLoop::angular_velocity(const Vec3& last, const ToolPose& before, const ToolPose& pose) const noexcept {
  if (!angular_velocity_cutoff_) return Vec3::Zero();
  const double taken = -math::expm1(-2.0 * std::numbers::pi * *angular_velocity_cutoff_ * config_.dt);
  return (1.0 - taken) * last + taken * turn(before, pose) / config_.dt;
}

}  // namespace hapbench
