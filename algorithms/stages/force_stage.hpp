#pragma once

#include <memory>
#include <optional>

#include "algorithms/rendering_config.hpp"
#include "sim/core/model_info.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

extern const ModelInfo kEnergyTankInfo;
extern const ModelInfo kActuatorLimitedPassivityInfo;

/// What a force stage sees of a row.
struct StageStep {
  Vec3 force;     ///< that would be rendered without the stage [N]
  Vec3 velocity;  ///< of the tool [m/s]
  /// What the stage has absorbed and can still give back [J], by the passivity observer: the energy of the springs in
  /// the first row, less the work that its answers have done on the tool since.
  double energy = 0.0;
};

/// A controller behind an algorithm: in every row, also in free air, it sees the force that a law with its damping,
/// friction and limits would render, and answers the force to render in its place. One object is the state of one run.
class ForceStage {
 public:
  virtual ~ForceStage() = default;
  /// Called once before the first row; may allocate. `time_step` of a row [s]; `mass` of the virtual tool [kg], 0 where
  /// a device's handle or a script moves the tool.
  virtual void prepare(double time_step, double mass) = 0;
  /// Returns to t = 0, bit for bit.
  virtual void reset() noexcept {}
  /// The force to render [N]; called once for each row.
  virtual Vec3 force(const StageStep& step) noexcept = 0;
};

/// An energy tank (after Franken et al. 2011 and Ferraguti et al. 2015): its level is the energy that the rendering has
/// absorbed, up to a capacity C beyond which it is lost. A force that would give away more over the coming step, at the
/// tool's velocity, than there is loses its part along the velocity until it gives away just that:
///
///   T <- min(C, T + absorbed);   f - (<f, v> dt - max(T, 0)) / (|v|^2 dt) v   where <f, v> dt > max(T, 0)
///
/// It takes push away and never resists: what the velocity changes within a step may overdraw the tank, which stays
/// below zero until as much has been absorbed. Without external force the energy given away in all stays bounded.
class EnergyTank final : public ForceStage {
 public:
  explicit EnergyTank(const EnergyTankConfig& config) : config_(config) {}

  void prepare(double time_step, double /*mass*/) override { dt_ = time_step; }
  void reset() noexcept override { level_ = energy_ = 0.0, begun_ = false; }
  Vec3 force(const StageStep& step) noexcept override;

 private:
  EnergyTankConfig config_;
  double dt_ = 0.0;
  double level_ = 0.0, energy_ = 0.0;
  bool begun_ = false;
};

/// A passivity controller (Hannaford and Ryu, 2002) that asks no actuator for more than it has. What a force would
/// overdraw of the observed energy E over the coming step, <f, v> dt - E > 0, is to be dissipated by damping, first
/// along the force, where damping relieves the actuators, and what is left at right angles to it, as in the prioritised
/// dissipation of Porcini and Frisoli (arXiv 2603.26347, of which we know the abstract; the formulas are ours):
///
///   f1 = f - a1 <v, n> n, n = f / |f|;   f2 = f1 - a2 (v - <v, n> n)
///
/// Each damping is the least that dissipates what is owed, cut to `max_damping`, beyond which a step reverses the
/// velocity, and to the closed form of |f1_j| <= F_j, then |f2_j| <= F_j. The actuators j are those of the world's
/// axes. What these limits leave undissipated stays owed, E < 0, and is taken in later rows that render a force; in
/// free air the stage renders nothing.
class ActuatorLimitedPassivity final : public ForceStage {
 public:
  explicit ActuatorLimitedPassivity(const ActuatorLimitedPassivityConfig& config) : config_(config) {}

  void prepare(double time_step, double mass) override;
  Vec3 force(const StageStep& step) noexcept override;

 private:
  ActuatorLimitedPassivityConfig config_;
  double dt_ = 0.0;
  double most_damping_ = 0.0;
};

/// An algorithm with a force stage behind it, whose answer is cut to the force limit again. A state within a step gets
/// the change of its row.
class StagedRendering final : public ForceAlgorithm {
 public:
  StagedRendering(std::unique_ptr<ForceAlgorithm> algorithm, std::unique_ptr<ForceStage> stage,
                  const RenderingConfig& config);

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override;
  SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept override {
    return algorithm_->spring_state(tool, contacts);
  }
  ForceJacobian jacobian() const noexcept override { return algorithm_->jacobian(); }
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return algorithm_->angular_velocity_cutoff();
  }
  AlgorithmWork work() const noexcept override;
  const char* fault() const noexcept override { return algorithm_->fault(); }

 private:
  std::unique_ptr<ForceAlgorithm> algorithm_;
  std::unique_ptr<ForceStage> stage_;
  RenderingConfig config_;
  Scene scene_;
  std::optional<std::uint64_t> row_;        ///< of the last answer
  Vec3 change_ = Vec3::Zero();              ///< of the row's force [N]
  ObservedEnergy given_{0.0}, asked_{0.0};  ///< of the stage's answers, and of the forces they replace
  std::uint64_t steps_staged_ = 0;
};

/// The stage of the configuration.
std::unique_ptr<ForceStage> make_force_stage(const ForceStageConfig& config);

}  // namespace hapbench
