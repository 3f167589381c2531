#pragma once

#include <memory>
#include <optional>

#include "sim/core/model_info.hpp"
#include "algorithms/rendering_config.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

extern const ModelInfo kPassivityControllerInfo;

/// A passivity controller around any force algorithm, after Hannaford and Ryu (2002) but looking one step ahead: the
/// tool's mass and f_in are known, so the work of a force over the coming step is known before it is rendered.
///
/// With w = v + f_in dt / (2 M) and u = w + f dt / M, a force f gives away M/2 (|u|^2 - |w|^2) of the observed energy E
/// by translation. If that leaves less than nothing, the controller renders
///
///   s f - alpha w,  alpha = (1 - s) M / dt,
///
/// which makes s u of u, with the largest s in [0, 1] that leaves nothing: of all forces that do, the one nearest to f.
/// It is adaptive damping, alpha of M / dt (s = 0) at most, which stops the tool and never turns it round. Before that,
/// the springs are weakened where the scripted rotation would draw more from their moment than E. How the axis will
/// turn over the coming step is not known: it is taken to go on as over the last, give or take twice the largest change
/// of the turn from a step to the next so far, whose work half the moment may do is kept in reserve.
///
/// Guarantee, where the integrator is leapfrog and the position is free: E is never negative but for rounding, as long
/// as no change of the turn is more than twice the largest before (the first turn of a run that starts in contact is
/// one). A law whose observed energy stays >= 0 without the controller is not touched, bit for bit, when the axis
/// stays, nor, when it turns, while that energy stays above the reserve. What another integrator, or a jerk beyond the
/// reserve, takes stays owed and is taken back from the next steps in contact.
///
/// In free air it renders nothing, whatever is owed.
class PassivityController final : public ForceAlgorithm {
 public:
  PassivityController(std::unique_ptr<ForceAlgorithm> algorithm, const RenderingConfig& config);

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  void take_input(const Vec3& input) noexcept override;
  /// f_spring and S are weakened like the springs they are of.
  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override;
  SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept override;
  ForceJacobian jacobian() const noexcept override;
  bool wants_input() const noexcept override { return true; }
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return algorithm_->angular_velocity_cutoff();
  }
  AlgorithmWork work() const noexcept override;
  const char* fault() const noexcept override { return algorithm_->fault(); }

 private:
  void note_turn() noexcept;
  void control(const ToolState& tool, const Vec3& force) noexcept;
  Vec3 limited(const Vec3& force) const noexcept;
  void render(const ToolState& tool, RenderedForce& out) const noexcept;

  std::unique_ptr<ForceAlgorithm> algorithm_;
  double mass_;
  std::optional<double> max_force_;
  double dt_ = 0.0;
  ObservedEnergy observed_{0.0};
  bool at_row_ = false;  ///< the next `compute` is that of a row and not within a step
  Vec3 input_ = Vec3::Zero();
  SpringState springs_;        ///< as they are rendered
  double share_ = 1.0;         ///< of the algorithm's force
  double spring_share_ = 1.0;  ///< of its springs' energy and moment: share_, or less where the limit cuts the force
  double alpha_ = 0.0;         ///< damping [N s/m]
  std::optional<Vec3> last_turn_;
  double largest_change_ = 0.0;  ///< of the turn from one step to the next, so far [rad]
  std::uint64_t steps_controlled_ = 0;
};

}  // namespace hapbench
