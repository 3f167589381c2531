#include "algorithms/stages/force_stage.hpp"

#include <utility>

#include "algorithms/stages/damping_and_limits.hpp"

namespace hapbench {

StagedRendering::StagedRendering(std::unique_ptr<ForceAlgorithm> algorithm, std::unique_ptr<ForceStage> stage,
                                 const RenderingConfig& config)
    : algorithm_(std::move(algorithm)), stage_(std::move(stage)), config_(config) {}

void StagedRendering::prepare(const Scene& scene) {
  algorithm_->prepare(scene);
  scene_ = scene;
  given_ = asked_ = ObservedEnergy(scene.dt, scene.position_is_free);
  const bool has_mass = scene.position_is_free && !scene.handle_moves_tool;
  stage_->prepare(scene.dt, has_mass ? config_.mass : 0.0);
}

void StagedRendering::reset() noexcept {
  algorithm_->reset();
  stage_->reset();
  given_.reset();
  asked_.reset();
  row_.reset();
  change_.setZero();
  steps_staged_ = 0;
}

void StagedRendering::compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept {
  algorithm_->compute(tool, contacts, out);
  const std::uint64_t row = scene_.row != nullptr ? *scene_.row : row_ ? *row_ + 1 : 0;
  if (row_ == row) {
    if (!change_.isZero(0.0)) out.rendered += change_;
    return;
  }
  const bool first = !row_;
  row_ = row;
  for (ObservedEnergy* port : {&given_, &asked_}) port->move(tool, scene_.handle_moves_tool);
  // The springs that a run begins with are energy to give back; the port of a stage is the tool's translation alone.
  const SpringState springs{first ? algorithm_->spring_state(tool, contacts).energy : 0.0, Vec3::Zero()};
  asked_.answer(tool, out.rendered, springs);
  // Before its answer, the port has the energy that the row begins with.
  given_.answer(tool, Vec3::Zero(), springs);
  const Vec3 answer = cut_to(stage_->force({out.rendered, tool.velocity, given_.energy()}), config_.max_force);
  given_.answer(tool, answer, springs);
  if (answer == out.rendered) {
    change_.setZero();
    return;
  }
  ++steps_staged_;
  change_ = answer - out.rendered;
  out.rendered = answer;
}

AlgorithmWork StagedRendering::work() const noexcept {
  AlgorithmWork work = algorithm_->work();
  work.steps_staged = steps_staged_;
  work.energy_staged = given_.energy() - asked_.energy();
  return work;
}

std::unique_ptr<ForceStage> make_force_stage(const ForceStageConfig& config) {
  if (const auto* tank = std::get_if<EnergyTankConfig>(&config)) return std::make_unique<EnergyTank>(*tank);
  return std::make_unique<ActuatorLimitedPassivity>(std::get<ActuatorLimitedPassivityConfig>(config));
}

}  // namespace hapbench
