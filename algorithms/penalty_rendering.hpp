#pragma once

#include <memory>

#include "algorithms/laws/force_law.hpp"
#include "algorithms/stages/damping_and_limits.hpp"

namespace hapbench {

/// An optional stage between depth model and force law that merges or drops contacts in place (thesis C.2, C.3).
class PointStage {
 public:
  virtual ~PointStage() = default;
  /// The only call that may allocate. Throws std::invalid_argument if the scene lacks what the stage needs.
  virtual void prepare(const Scene& scene) = 0;
  virtual void reset() noexcept { dropped_ = 0; }
  /// Takes and leaves padded contacts, never more than before.
  virtual void process(ContactBuffer& contacts) noexcept = 0;
  /// Contacts lost because a buffer was full, since the last reset.
  std::uint64_t dropped() const noexcept { return dropped_; }

 protected:
  std::uint64_t dropped_ = 0;
};

extern const ModelInfo kLocalAverageInfo;
extern const ModelInfo kGradientReductionInfo;

/// Its `prepare` needs a shell with grid cells (PointShell::cell_size > 0).
std::unique_ptr<PointStage> make_local_average();
std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config);

/// Penalty-based rendering, the thesis's pipeline, as one force algorithm:
///
///   contacts with depths -> (local average) -> (reduction) -> force law -> damping, friction, limits
///
/// One virtual call per stage and step. Stages that the configuration does not ask for do not exist. Steps without
/// contacts, or with too few to reduce, skip the stages that would do nothing (Skips).
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

  std::unique_ptr<PointStage> local_average_;  ///< may be null
  std::unique_ptr<PointStage> reduction_;      ///< may be null
  std::unique_ptr<ForceLaw> law_;
  DampingAndLimits damping_and_limits_;
  Skips skips_;
  double K_;
  bool in_contact_ = false;  ///< in the last step
  LawForce law_force_;       ///< answer of the law in the last step with contacts
};

}  // namespace hapbench
