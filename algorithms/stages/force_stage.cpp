#include "algorithms/stages/force_stage.hpp"

#include <map>
#include <stdexcept>
#include <utility>

#include "algorithms/stages/damping_and_limits.hpp"
#include "sim/loop/hand.hpp"

namespace hapbench {
namespace {

void put(const Vec3& from, double (&to)[3]) noexcept {
  Vec3::Map(to) = from;
}

/// The springs that a run begins with are energy to give back; the port of a stage is the tool's translation alone.
SpringState energy_alone(SpringState springs) noexcept {
  springs.moment.setZero();
  return springs;
}

std::map<std::string, ForceStageMaker>& added_stages() {
  static std::map<std::string, ForceStageMaker> all;
  return all;
}

}  // namespace

StagedRendering::StagedRendering(std::unique_ptr<ForceAlgorithm> algorithm, std::unique_ptr<ForceStage> stage,
                                 const RenderingConfig& config)
    : algorithm_(std::move(algorithm)), stage_(std::move(stage)), config_(config) {}

void StagedRendering::prepare(const Scene& scene) {
  algorithm_->prepare(scene);
  scene_ = scene;
  given_ = asked_ = ObservedEnergy(scene.dt, scene.position_is_free);
  const bool has_mass = scene.position_is_free && !scene.handle_moves_tool;
  stage_->prepare({scene.dt, has_mass ? config_.mass : 0.0, config_.stiffness});
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

HapbenchStageStep StagedRendering::step_at(const ToolState& tool, const ContactBuffer& contacts,
                                           const RenderedForce& out) noexcept {
  const Mat3& S = out.S;
  HapbenchStageStep step = {};
  step.row = *row_;
  std::size_t next = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) step.stiffness[next++] = S(i, j);
  step.energy = given_.energy();
  step.in_contact = contacts.empty() ? 0 : 1;
  put(out.rendered, step.force);
  put(out.spring, step.spring);
  put(tool.pose.position, step.position);
  put(tool.velocity, step.velocity);
  put(scene_.handle != nullptr ? scene_.handle->position : tool.pose.position, step.device_position);
  put(scene_.handle != nullptr ? scene_.handle->velocity : tool.velocity, step.device_velocity);
  put(scene_.input != nullptr ? *scene_.input : Vec3(Vec3::Zero()), step.device_force);
  return step;
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
  const SpringState springs = first ? energy_alone(algorithm_->spring_state(tool, contacts)) : SpringState{};
  asked_.answer(tool, out.rendered, springs);
  // Before its answer, the port has the energy that the row begins with.
  given_.answer(tool, Vec3::Zero(), springs);
  const Vec3 answer = cut_to(stage_->force(step_at(tool, contacts, out)), config_.max_force);
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

const char* StagedRendering::fault() const noexcept {
  const char* fault = algorithm_->fault();
  return fault != nullptr ? fault : stage_->fault();
}

void add_force_stage(const std::string& name, ForceStageMaker make) {
  added_stages()[name] = std::move(make);
}

const ForceStageMaker* find_force_stage(const std::string& name) {
  const auto found = added_stages().find(name);
  return found == added_stages().end() ? nullptr : &found->second;
}

std::string added_force_stages() {
  std::string names;
  for (const auto& [name, make] : added_stages()) names += (names.empty() ? "\"" : ", \"") + name + "\"";
  return names.empty() ? "none was added" : names;
}

std::unique_ptr<ForceStage> make_force_stage(const RenderingConfig& config, const HapbenchForceStage* library) {
  const ForceStageConfig& stage = *config.force_stage;
  if (const auto* tank = std::get_if<EnergyTankConfig>(&stage)) return std::make_unique<EnergyTank>(*tank);
  if (const auto* limited = std::get_if<ActuatorLimitedPassivityConfig>(&stage))
    return std::make_unique<ActuatorLimitedPassivity>(*limited);
  if (const auto* plugin = std::get_if<PluginStageConfig>(&stage)) {
    if (library == nullptr) throw std::invalid_argument("the force stage's library is not loaded");
    return make_plugin_stage(*library, plugin->config);
  }
  const auto& added = std::get<AddedStageConfig>(stage);
  const ForceStageMaker* make = find_force_stage(added.name);
  if (make == nullptr) throw std::invalid_argument("unknown force stage " + added.name);
  return (*make)(added.config);
}

}  // namespace hapbench
