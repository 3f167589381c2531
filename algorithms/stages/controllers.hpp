#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "algorithms/rendering_config.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

extern const ModelInfo kEnergyTankInfo;
extern const ModelInfo kActuatorLimitedPassivityInfo;
extern const ModelInfo kPassivityControllerInfo;

/// Input of a force stage: the force and the motion of one row.
struct StageStep {
  Vec3 force;     ///< that would be rendered without the stage, with damping, friction and limits [N]
  Vec3 velocity;  ///< of the tool [m/s]
  /// Energy that the stage has absorbed and may give back [J], by the passivity observer: that of the springs in
  /// the first row, less the work that its answers have done on the tool since.
  double energy = 0.0;
};

/// A controller behind an algorithm, which answers the force to render in place of the algorithm's, in every row, also
/// in free air. One object is the state of one run.
class ForceStage {
 public:
  virtual ~ForceStage() = default;
  /// Called once before the first row; may allocate. `time_step` of a row [s]; `mass` of the virtual tool [kg], 0 where
  /// a device's handle or a script moves the tool.
  virtual void prepare(double time_step, double mass) = 0;
  /// Returns to t = 0, bit for bit.
  virtual void reset() noexcept {}
  /// [N]; called once for each row.
  virtual Vec3 force(const StageStep& step) noexcept = 0;
};

/// An energy tank (kEnergyTankInfo has formula and source): its level T [J] is the energy that the rendering has
/// absorbed, up to a capacity C beyond which it is lost. A force that would give away more over the coming step, at the
/// tool's velocity, than there is loses its part along the velocity until it gives away just that. It takes push away
/// and never resists: what the velocity changes within a step may overdraw the tank, which stays below zero until as
/// much has been absorbed. Without external force the energy given away in all stays bounded.
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
/// along the force, where damping relieves the actuators, and what is left at right angles to it: the prioritised
/// dissipation of Porcini and Frisoli, of whom we know the abstract, by formulas of ours
/// (kActuatorLimitedPassivityInfo). Each damping is the least that dissipates what is owed, cut to `max_damping`,
/// beyond which a step reverses the velocity, and to what keeps the force within the actuators' limits; they are those
/// of the world's axes. What is left undissipated stays owed, E < 0, and is taken in later rows that render a force; in
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
                  const RenderingConfig& config)
      : algorithm_(std::move(algorithm)), stage_(std::move(stage)), config_(config) {}

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

/// A passivity controller around any force algorithm, after Hannaford and Ryu (2002) but looking one step ahead: mass
/// and f_in are known, so the work of a force over the coming step is known before it is rendered.
///
/// With w = v + f_in dt / (2 M) and u = w + f dt / M, a force f gives away M/2 (|u|^2 - |w|^2) of the observed energy E
/// by translation. If that would make E negative, the controller renders
///
///   s f - alpha w,  alpha = (1 - s) M / dt,
///
/// which replaces u by s u, with the largest s in [0, 1] for which E stays >= 0: of all such forces the one nearest to
/// f. It is adaptive damping, which at most (s = 0) stops the tool and never reverses it. Before that, the springs are
/// weakened if the scripted rotation would draw more energy than E from their moment. The rotation over the coming step
/// is assumed to be that of the last step, plus or minus twice the largest change of the turn between two steps so far;
/// the work of half the moment over that change is kept in reserve. In free air the controller renders nothing.
///
/// Guarantee for the leapfrog integrator and a free position: E is never negative but for rounding, as long as no
/// change of the turn exceeds twice the largest before (the first turn of a run that starts in contact does). A law
/// whose observed energy stays >= 0 without the controller keeps its bytes if the axis stays, and, if the axis turns,
/// while that energy stays above the reserve. Energy that another integrator or a jerk beyond the reserve takes stays
/// owed and is taken back in the next steps in contact.
class PassivityController final : public ForceAlgorithm {
 public:
  PassivityController(std::unique_ptr<ForceAlgorithm> algorithm, const RenderingConfig& config)
      : algorithm_(std::move(algorithm)), mass_(config.mass), max_force_(config.max_force) {}

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
  double alpha_ = 0.0;                     ///< damping [N s/m]
  std::optional<Vec3> last_turn_;
  double largest_change_ = 0.0;  ///< largest change of the turn between two steps so far [rad]
  std::uint64_t steps_controlled_ = 0;
};

}  // namespace hapbench
