#include "algorithms/penalty_rendering.hpp"

#include <algorithm>
#include <utility>

#include "algorithms/points/gradient_reduction.hpp"
#include "algorithms/points/local_average.hpp"

namespace hapbench {

PenaltyRendering::PenaltyRendering(std::unique_ptr<DepthModel> depth_model, std::unique_ptr<ForceLaw> law,
                                   const RenderingConfig& config)
    : depth_model_(std::move(depth_model)),
      local_average_(config.local_average ? make_local_average() : nullptr),
      reduction_(config.reduction ? make_gradient_reduction(*config.reduction) : nullptr),
      law_(std::move(law)),
      damping_and_limits_(config) {}

void PenaltyRendering::prepare(const Scene& scene) {
  tool_ = scene.tool;
  depth_is_given_ = scene.query->gives_depth();
  if (local_average_) local_average_->prepare(scene);
  if (reduction_) reduction_->prepare(scene);
  law_->prepare(scene.query->capacity());
}

void PenaltyRendering::reset() noexcept {
  if (local_average_) local_average_->reset();
  if (reduction_) reduction_->reset();
  law_->reset();
}

void PenaltyRendering::compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept {
  out = {};
  if (contacts.empty()) return;

  if (!depth_is_given_) depth_model_->evaluate(tool_, tool.pose, contacts);
  const auto depths = contacts.depth.begin();
  out.depth_max = *std::max_element(depths, depths + static_cast<std::ptrdiff_t>(contacts.size()));

  if (local_average_) local_average_->process(contacts);
  if (reduction_) reduction_->process(contacts);
  if (contacts.empty()) return;

  const LawForce law = law_->evaluate(contacts);
  out.spring = spring_ = law.spring;
  out.S = law.S;
  out.rendered = damping_and_limits_.rendered_force(law.spring, law.S, tool.velocity);
}

SpringState PenaltyRendering::spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept {
  return contacts.empty() ? SpringState{} : law_->spring_state(contacts, spring_, tool.pose.position);
}

AlgorithmWork PenaltyRendering::work() const noexcept {
  return {law_->iterations(), reduction_ ? reduction_->dropped() : 0};
}

}  // namespace hapbench
