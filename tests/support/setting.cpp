#include "tests/support/setting.hpp"

#include <Eigen/Geometry>

#include "device_model/hands/scripted_hands.hpp"
#include "device_model/ideal_device.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "sim/contact/spring_query.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::test {
namespace {

std::shared_ptr<const PointShell> shell_of(const Setting& setting) {
  return setting.springs ? nullptr : std::make_shared<const PointShell>(setting.points, setting.cell_size);
}

std::unique_ptr<ContactQuery> query_of(const Setting& setting, const PointShell* shell, const ToolShape& tool) {
  if (setting.springs) return std::make_unique<SpringQuery>(*setting.springs);
  return std::make_unique<NeighbourListQuery>(*shell, tool);
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
  setting.points = shuffled(std::move(setting.points), random);
  if (setting.springs) setting.springs->gradients = shuffled(std::move(setting.springs->gradients), random);
  return setting;
}

Probe::Probe(const Setting& setting, const RenderingConfig& config)
    : tool_(setting.tool),
      shell_(shell_of(setting)),
      query_(query_of(setting, shell_.get(), tool_)),
      algorithm_(make_algorithm(config)),
      contacts_(query_->capacity()) {
  algorithm_->prepare({&tool_, query_.get(), shell_.get()});
  algorithm_->reset();
}

RenderedForce Probe::force_at(const ToolPose& pose, const Vec3& velocity, const Vec3& angular_velocity) {
  query_->contacts_at(pose, contacts_);
  RenderedForce force;
  algorithm_->compute({pose, velocity, angular_velocity}, contacts_, force);
  return force;
}

SimulationParts free_run(const Setting& setting, const RenderingConfig& config) {
  SimulationParts parts;
  parts.tool = std::make_shared<Cylinder>(setting.tool);
  parts.shell = shell_of(setting);
  parts.query = query_of(setting, parts.shell.get(), *parts.tool);
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
