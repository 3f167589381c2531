#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "algorithms/plugin/hapbench_force_stage.h"
#include "algorithms/rendering_config.hpp"
#include "sim/core/model_info.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

extern const ModelInfo kEnergyTankInfo;
extern const ModelInfo kActuatorLimitedPassivityInfo;

/// A controller behind an algorithm: answers the force to render in place of the one that the algorithm renders. One
/// object is the state of one run. The row it sees and what it is for are those of the C interface.
class ForceStage {
 public:
  virtual ~ForceStage() = default;
  /// Called once before the first row; may allocate and throw.
  virtual void prepare(const HapbenchStageRun& run) = 0;
  /// Returns to t = 0, bit for bit.
  virtual void reset() noexcept = 0;
  /// The force to render [N]; called once for each row.
  virtual Vec3 force(const HapbenchStageStep& step) noexcept = 0;
  /// Description of a failure in external code since the last reset; null if there was none.
  virtual const char* fault() const noexcept { return nullptr; }
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

  void prepare(const HapbenchStageRun& run) override { dt_ = run.time_step; }
  void reset() noexcept override { level_ = energy_ = 0.0, begun_ = false; }
  Vec3 force(const HapbenchStageStep& step) noexcept override;

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

  void prepare(const HapbenchStageRun& run) override;
  void reset() noexcept override {}
  Vec3 force(const HapbenchStageStep& step) noexcept override;

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

  /// Throws what the stage throws.
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
  const char* fault() const noexcept override;

 private:
  HapbenchStageStep step_at(const ToolState& tool, const ContactBuffer& contacts, const RenderedForce& out) noexcept;

  std::unique_ptr<ForceAlgorithm> algorithm_;
  std::unique_ptr<ForceStage> stage_;
  RenderingConfig config_;
  Scene scene_;
  std::optional<std::uint64_t> row_;        ///< of the last answer
  Vec3 change_ = Vec3::Zero();              ///< of the row's force [N]
  ObservedEnergy given_{0.0}, asked_{0.0};  ///< of the stage's answers, and of the forces they replace
  std::uint64_t steps_staged_ = 0;
};

/// A stage that is made from the config of a scenario as JSON text. May throw.
using ForceStageMaker = std::function<std::unique_ptr<ForceStage>(const std::string& config)>;

/// Adds a stage of this process, or replaces the one of that name. Must not be called while another thread reads them.
void add_force_stage(const std::string& name, ForceStageMaker make);
/// Null if no stage of that name was added.
const ForceStageMaker* find_force_stage(const std::string& name);
/// The names of added stages, for messages.
std::string added_force_stages();

/// The stage of a library, which must outlive it (algorithms/plugin/plugin_stage.cpp). Its `prepare` throws
/// std::runtime_error with the library's fault.
std::unique_ptr<ForceStage> make_plugin_stage(const HapbenchForceStage& library, const std::string& config);

/// The stage of the configuration. `library` is that of PluginStageConfig, and null else. Throws std::invalid_argument
/// for a name that was not added and for a plugin without a library. Precondition: the configuration has a stage.
std::unique_ptr<ForceStage> make_force_stage(const RenderingConfig& config, const HapbenchForceStage* library);

}  // namespace hapbench
