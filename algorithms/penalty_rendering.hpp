#pragma once

#include <memory>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "algorithms/stages/point_stage.hpp"

namespace hapbench {

/// Penalty-based rendering, the pipeline of the thesis, as one force algorithm:
///
///   contacts with depths -> (local average) -> (reduction) -> force law -> damping, friction, limits
///
/// Each stage costs one virtual call in each step. Only the stages in the configuration are created. With Skips::on, a
/// step without contacts skips all stages, and a step with one contact skips the reduction. The skipped stages would
/// change nothing.
class PenaltyRendering final : public ForceAlgorithm {
 public:
  PenaltyRendering(std::unique_ptr<ForceLaw> law, const RenderingConfig& config);

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override;
  SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept override;
  ForceJacobian jacobian() const noexcept override;
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return damping_and_limits_.angular_velocity_cutoff();
  }
  AlgorithmWork work() const noexcept override { return {law_->iterations(), reduction_ ? reduction_->dropped() : 0}; }
  const char* fault() const noexcept override { return law_->fault(); }

 private:
  void render(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept;
  ContactVelocity velocity_at(const ContactBuffer& contacts, const ToolState& tool) const noexcept;

  std::unique_ptr<PointStage> local_average_;  ///< null if not configured
  std::unique_ptr<PointStage> reduction_;      ///< null if not configured
  std::unique_ptr<ForceLaw> law_;
  DampingAndLimits damping_and_limits_;
  Skips skips_;
  double K_;
  bool in_contact_ = false;  ///< true if the last step had contacts after the point stages
  LawForce law_force_;       ///< result of the law in the last step with contacts
};

}  // namespace hapbench
