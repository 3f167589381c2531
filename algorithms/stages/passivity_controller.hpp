#pragma once

#include <memory>
#include <optional>

#include "algorithms/rendering_config.hpp"
#include "sim/core/model_info.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

extern const ModelInfo kPassivityControllerInfo;

/// A passivity controller around any force algorithm, after Hannaford and Ryu (2002) but looking one step ahead: the
/// tool's mass and f_in are known, so the work of a force over the coming step is known before it is rendered.
///
/// With w = v + f_in dt / (2 M) and u = w + f dt / M, a force f gives away M/2 (|u|^2 - |w|^2) of the observed energy E
/// by translation. If that would make E negative, the controller renders
///
///   s f - alpha w,  alpha = (1 - s) M / dt,
///
/// which replaces u by s u, with the largest s in [0, 1] for which E stays >= 0. Of all such forces it is the one
/// nearest to f. It is adaptive damping with alpha <= M / dt (s = 0), which stops the tool and never reverses it.
/// Before that, the springs are weakened if the scripted rotation would draw more energy than E from their moment. The
/// rotation over the coming step is not known. It is assumed to be that of the last step, plus or minus twice the
/// largest change of the turn between two steps so far; the work of half the moment over that change is kept in
/// reserve.
///
/// Guarantee for the leapfrog integrator and a free position: E is never negative but for rounding, as long as no
/// change of the turn exceeds twice the largest before (the first turn of a run that starts in contact is such a
/// change). A law whose observed energy stays >= 0 without the controller keeps its bytes if the axis stays, and, if
/// the axis turns, while that energy stays above the reserve. Energy that another integrator or a jerk beyond the
/// reserve takes stays owed and is taken back in the next steps in contact.
///
/// In free air the controller renders nothing, whatever is owed.
class PassivityController final : public ForceAlgorithm {
 public:
  PassivityController(std::unique_ptr<ForceAlgorithm> algorithm, const RenderingConfig& config);

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  /// Weakens f_spring and S with the springs.
  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override;
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override { return springs_; }
  ForceJacobian jacobian() const noexcept override;
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return algorithm_->angular_velocity_cutoff();
  }
  AlgorithmWork work() const noexcept override;
  const char* fault() const noexcept override { return algorithm_->fault(); }

 private:
  void note_turn() noexcept;
  void control(const ToolState& tool, const Vec3& force) noexcept;
  void render(const ToolState& tool, RenderedForce& out) const noexcept;
  /// Velocity change over half a step by f_in [m/s].
  Vec3 half_kick() const noexcept { return *input_ * (0.5 * dt_ / mass_); }

  std::unique_ptr<ForceAlgorithm> algorithm_;
  double mass_;
  std::optional<double> max_force_;
  double dt_ = 0.0;
  ObservedEnergy observed_{0.0};
  const std::uint64_t* row_ = nullptr;     ///< Scene::row
  const Vec3* input_ = nullptr;            ///< Scene::input, f_in [N]
  std::optional<std::uint64_t> last_row_;  ///< row of the last `compute`
  SpringState springs_;                    ///< springs as rendered
  double share_ = 1.0;                     ///< rendered share of the algorithm's force
  double spring_share_ = 1.0;              ///< share of energy and moment: share_, or less if the limit cuts the force
  double alpha_ = 0.0;                     ///< damping [N s/m]
  std::optional<Vec3> last_turn_;
  double largest_change_ = 0.0;  ///< largest change of the turn between two steps so far [rad]
  std::uint64_t steps_controlled_ = 0;
};

}  // namespace hapbench
