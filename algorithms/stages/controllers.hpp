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

/// Input of a force stage in one step.
struct StageStep {
  Vec3 force;     ///< force that would be rendered without the stage, after damping, friction and limits [N]
  Vec3 velocity;  ///< velocity of the tool [m/s]
  /// Energy [J] that the stage has absorbed and may return, from the passivity observer: the energy of the
  /// springs in the first step, minus the work that the rendered forces have done on the tool since.
  double energy = 0.0;
};

/// A controller after an algorithm: replaces the algorithm's force by the force to render. Called in every
/// step, also in free air. One instance holds the state of one run.
class ForceStage {
 public:
  virtual ~ForceStage() = default;
  /// Called once before the first step; may allocate. `time_step`: [s]. `mass`: mass of the virtual tool [kg],
  /// 0 if a device's handle or a script moves the tool.
  virtual void prepare(double time_step, double mass) = 0;
  /// Returns to t = 0, so that the next run is bitwise identical to a run with a new object.
  virtual void reset() noexcept {}
  /// Returns the force to render [N]. Called once in every step.
  virtual Vec3 force(const StageStep& step) noexcept = 0;
};

/// An energy tank (formula and source: kEnergyTankInfo). Its level T [J] is the energy that the rendering has
/// absorbed, up to the capacity C; energy beyond C is lost. If the force would return more energy than T over
/// the coming step, at the tool's current velocity, its component along the velocity is reduced until it
/// returns exactly T.
///
/// The tank only reduces a pushing force; it never adds resistance. The velocity changes within a step, so the
/// level may fall below zero; it stays there until enough energy has been absorbed. Without external force, the
/// total energy returned is bounded.
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

/// A passivity controller (Hannaford and Ryu, 2002) that respects the limits of the actuators. Over the coming step,
/// a force f would return the energy <f, v> dt. If this is more than the observed energy E, damping must dissipate
/// the excess <f, v> dt - E: first damping along the force, which relieves the actuators, then damping at right
/// angles to the force for the remainder. This prioritised dissipation follows the abstract of Porcini and Frisoli;
/// the formulas were derived for this project (kActuatorLimitedPassivityInfo).
///
/// Each of the two dampings is the smallest that dissipates the remaining excess. It is at most `max_damping`, beyond
/// which a step would reverse the velocity, and at most the damping that keeps the force within the actuators' limits
/// along the world axes. Energy that is not dissipated remains as a debt, E < 0, and is dissipated in later steps
/// that render a force. In free air the stage renders nothing.
class ActuatorLimitedPassivity final : public ForceStage {
 public:
  explicit ActuatorLimitedPassivity(const ActuatorLimitedPassivityConfig& config) : config_(config) {}

  void prepare(double time_step, double mass) override;
  Vec3 force(const StageStep& step) noexcept override;

 private:
  ActuatorLimitedPassivityConfig config_;
  double dt_ = 0.0;
  double max_damping_ = 0.0;  ///< largest damping b [N s/m]
};

/// An algorithm followed by a force stage. The stage's force is limited to max_force again. The stage computes its
/// change of the force once per step. If an integrator evaluates the force within the step, the same change is added to
/// the algorithm's force at that time.
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
  std::optional<std::uint64_t> row_;  ///< last step in which the stage was called
  Vec3 change_ = Vec3::Zero();        ///< rendered force minus the algorithm's force in this step [N]
  /// Energy [J] that the passivity observer computes for the rendered forces, and for the algorithm's forces before the
  /// stage.
  ObservedEnergy rendered_energy_{0.0}, requested_energy_{0.0};
  std::uint64_t steps_staged_ = 0;
};

/// A passivity controller around any force algorithm, after Hannaford and Ryu (2002), but with a prediction of
/// one step: mass M and input force f_in are known, so the work of a force over the coming step is known before
/// it is rendered.
///
/// Let w = v + f_in dt / (2 M) and u = w + f dt / M. By translation, a force f returns M/2 (|u|^2 - |w|^2) of
/// the observed energy E. If this would make E negative, the controller renders
///
///   s f - alpha w,  alpha = (1 - s) M / dt,
///
/// which replaces u by s u. s is the largest value in [0, 1] for which E stays >= 0, so this is the force
/// nearest to f. The controller is adaptive damping: at s = 0 it stops the tool, and it never reverses the
/// velocity.
///
/// Before this computation, the springs are weakened if the scripted rotation would draw more energy than E from the
/// moment of the springs. The rotation of the coming step is predicted as the last step's rotation, plus or minus twice
/// the largest change of rotation between two steps so far. For this uncertainty the controller keeps an energy in
/// reserve: the norm of the moment times this largest change. In free air the controller renders nothing.
///
/// Guarantee for the leapfrog integrator and a free position: E is never negative, up to rounding, while no change of
/// the rotation between two steps exceeds twice the largest earlier change. In a run that starts in contact, the first
/// rotation exceeds this bound, because there is no earlier change. For a law whose observed energy stays >= 0 without
/// the controller, the force is bitwise unchanged if the tool's axis is fixed. If the axis turns, the force is
/// unchanged while this energy stays above the reserve.
/// Another integrator, or a jerk for which the reserve is too small, may make E negative; the next steps in contact
/// then dissipate this debt.
class PassivityController final : public ForceAlgorithm {
 public:
  PassivityController(std::unique_ptr<ForceAlgorithm> algorithm, const RenderingConfig& config)
      : algorithm_(std::move(algorithm)), mass_(config.mass), max_force_(config.max_force) {}

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  /// Computes the controlled force. Multiplies f_spring and S by the rendered fraction of the algorithm's force.
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
  /// Returns the change of velocity that f_in causes in half a step [m/s].
  Vec3 half_kick() const noexcept { return *input_ * (0.5 * dt_ / mass_); }

  std::unique_ptr<ForceAlgorithm> algorithm_;
  double mass_;
  std::optional<double> max_force_;
  double dt_ = 0.0;
  ObservedEnergy observed_{0.0};
  const std::uint64_t* row_ = nullptr;     ///< Scene::row
  const Vec3* input_ = nullptr;            ///< Scene::input, f_in [N]
  std::optional<std::uint64_t> last_row_;  ///< step of the last call of `compute`; empty before the first call
  SpringState springs_;                    ///< energy and moment of the springs after scaling
  double scale_ = 1.0;  ///< rendered fraction of the algorithm's force: s times the weakening of the springs
  double alpha_ = 0.0;  ///< alpha, damping [N s/m]
  std::optional<Vec3> last_turn_;
  double largest_change_ = 0.0;  ///< largest change of the rotation vector between two steps so far [rad]
  std::uint64_t steps_controlled_ = 0;
};

}  // namespace hapbench
