#include "tests/support/setting.hpp"

#include <Eigen/Geometry>

#include "algorithms/depth/depth_model.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "sim/contact/contact_source.hpp"

namespace hapbench::test {
namespace {

std::shared_ptr<const PointShell> shell_of(const Setting& setting) {
  return setting.springs ? nullptr : std::make_shared<const PointShell>(setting.points, setting.cell_size);
}

std::shared_ptr<const SpringSet> springs_of(const Setting& setting) {
  return setting.springs ? std::make_shared<const SpringSet>(*setting.springs) : nullptr;
}

std::unique_ptr<ContactSource> source_of(const PointShell* shell, std::shared_ptr<const SpringSet> springs,
                                         const ToolShape& tool, const RenderingConfig& config) {
  if (springs) return std::make_unique<SpringSource>(std::move(springs));
  return std::make_unique<ShellSource>(*shell, tool, make_contact_query(*shell, tool, Skips::on),
                                       make_depth_model(config), config.skips);
}

}  // namespace

Setting moved(Setting setting, const Mat3& R, const Vec3& t) {
  setting.pose = {R * setting.pose.position + t, R * setting.pose.axis};
  for (SurfacePoint& point : setting.points) point = {R * point.position + t, R * point.normal};
  if (setting.springs) {
    for (Vec3& u : setting.springs->gradients) u = R * u;
  }
  return setting;
}

Setting scaled(Setting setting, double s) {
  setting.tool = {s * setting.tool.radius(), s * setting.tool.length(), setting.tool.tip()};
  setting.pose.position *= s;
  setting.cell_size *= s;
  for (SurfacePoint& point : setting.points) point.position *= s;
  return setting;
}

Setting permuted(Setting setting, Random& random) {
  random.shuffle(setting.points);
  if (setting.springs) random.shuffle(setting.springs->gradients);
  return setting;
}

Probe::Probe(const Setting& setting, const RenderingConfig& config)
    : tool_(setting.tool),
      shell_(shell_of(setting)),
      springs_(springs_of(setting)),
      source_(source_of(shell_.get(), springs_, tool_, config)),
      algorithm_(make_algorithm(config)),
      contacts_(source_->capacity()) {
  algorithm_->prepare({source_->capacity(), &tool_, shell_.get(), springs_.get()});
  algorithm_->reset();
}

RenderedForce Probe::force_at(const ToolPose& pose, const Vec3& velocity, const Vec3& angular_velocity) {
  source_->contacts_at(pose, contacts_);
  RenderedForce force;
  algorithm_->compute({pose, velocity, angular_velocity}, contacts_, force);
  return force;
}

SimulationParts free_run(const Setting& setting, const RenderingConfig& config) {
  SimulationParts parts;
  parts.tool = std::make_shared<Cylinder>(setting.tool);
  parts.shell = shell_of(setting);
  parts.springs = springs_of(setting);
  parts.source = source_of(parts.shell.get(), parts.springs, *parts.tool, config);
  if (config.late)
    parts.source =
        std::make_unique<LateContacts>(std::move(parts.source), *config.late, setting.springs.has_value(), 1);
  parts.algorithm = make_algorithm(config);
  parts.motion = constant_axis(setting.pose.axis);
  parts.hand = std::make_unique<NoHand>();
  parts.device = std::make_unique<IdealDevice>(std::nullopt);
  return parts;
}

SimulationConfig free_run_config(const Setting& setting, const RenderingConfig& config, std::uint64_t steps) {
  SimulationConfig simulation;
  simulation.steps = steps;
  simulation.mass = config.mass;
  simulation.position = setting.pose.position;
  return simulation;
}

std::unique_ptr<Motion> constant_axis(const Vec3& axis) {
  // At tilt 0 the axis is -up, whatever the direction of lean.
  return std::make_unique<ScriptedMotion>(Orientation{-axis, axis.unitOrthogonal(), {}, {}}, std::nullopt);
}

}  // namespace hapbench::test
