#include "algorithms/penalty_rendering.hpp"

#include <Eigen/Geometry>
#include <utility>

namespace hapbench {

/// Zero force that is copied to the result in every step. The default constructor would write the zeros one by one, and
/// the processor would stall when it later reads two zeros at a time.
static const RenderedForce kNoForce;

PenaltyRendering::PenaltyRendering(std::unique_ptr<ForceLaw> law, const RenderingConfig& config)
    : local_average_(config.local_average ? make_local_average() : nullptr),
      reduction_(config.reduction ? make_gradient_reduction(*config.reduction) : nullptr),
      law_(std::move(law)),
      damping_and_limits_(config),
      skips_(config.skips),
      K_(config.stiffness) {}

void PenaltyRendering::prepare(const Scene& scene) {
  if (local_average_) local_average_->prepare(scene);
  if (reduction_) reduction_->prepare(scene);
  law_->prepare(scene.capacity);
  damping_and_limits_.prepare(scene);
}

void PenaltyRendering::reset() noexcept {
  if (local_average_) local_average_->reset();
  if (reduction_) reduction_->reset();
  law_->reset();
  damping_and_limits_.release();
}

void PenaltyRendering::compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept {
  out = kNoForce;
  in_contact_ = false;
  if (!contacts.empty() || skips_ == Skips::off) render(tool, contacts, out);
  if (!in_contact_) damping_and_limits_.release();
}

void PenaltyRendering::render(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept {
  out.depth_max = contacts.largest_depth();
  if (local_average_) local_average_->process(contacts);
  // A single contact has no similar contact, so the reduction would change nothing.
  if (reduction_ && (contacts.size() > 1 || skips_ == Skips::off)) reduction_->process(contacts);
  if (contacts.empty() && skips_ == Skips::on) return;

  const LawForce& law = law_force_ = law_->evaluate(contacts);
  // Without contacts, -K times an empty sum is -0. Adding zero gives 0, as in a step that skips the law.
  out.spring = contacts.empty() ? Vec3(law.spring + Vec3::Zero()) : law.spring;
  out.S = law.S;
  // Stop here without contacts, also with Skips::off: S is zero, so the whole velocity would count as
  // tangential.
  if (contacts.empty()) return;
  in_contact_ = true;
  Mat3 loads;  // initialised only if needs_loads()
  // A law without weights has a single load along its spring force.
  if (damping_and_limits_.needs_loads())
    loads = law_->gives_weights() ? Mat3(K_ * load_tensor(contacts)) : load_along(law.spring);
  out.rendered = damping_and_limits_.rendered_force(law.spring, law.S, velocity_at(contacts, tool), loads);
  out.friction = damping_and_limits_.friction_state();
}

ContactVelocity PenaltyRendering::velocity_at(const ContactBuffer& contacts, const ToolState& tool) const noexcept {
  const Mat3& S = law_force_.S;
  ContactVelocity velocity{tool.velocity, S * tool.velocity};
  if (angular_velocity_cutoff() && tool.angular_velocity != Vec3::Zero()) {
    velocity.mean += tool.angular_velocity.cross(mean_arm(contacts, tool.pose.position));
    velocity.normal += law_->turning_velocity(contacts, S, tool);
  }
  return velocity;
}

SpringState PenaltyRendering::spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept {
  if (contacts.empty()) return {};
  SpringState state = law_->spring_state(contacts, law_force_.spring, tool.pose.position);
  state.energy += damping_and_limits_.stored_energy();
  return state;
}

ForceJacobian PenaltyRendering::jacobian() const noexcept {
  if (!in_contact_) return {};
  const auto& [spring, S] = law_force_;
  return {K_ * S, damping_and_limits_.damping_matrix(spring, S)};
}

}  // namespace hapbench
