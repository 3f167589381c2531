#pragma once

#include <gtest/gtest.h>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "sim/core/random.hpp"

namespace hapbench::test {

/// Lowers a tool from `start` by 50 µm a step into a shell under the proxy algorithm and expects the proxy to keep out:
/// `deepest(pose)` [m], the largest depth of a point of the shell in the tool at a pose, stays that of rounding.
template <class Deepest>
void expect_proxy_stays_out(const ToolShape& tool, const PointShell& shell, const ToolPose& start, int steps,
                            const Deepest& deepest) {
  RenderingConfig config;
  config.algorithm = "proxy";
  ShellSource source(shell, tool, make_contact_query(shell, tool, Skips::on), make_depth_model(config));
  ContactBuffer contacts(source.capacity());
  const auto proxy = make_algorithm(config);
  proxy->prepare({source.capacity(), &tool, &shell});
  proxy->reset();
  RenderedForce force;
  ToolPose pose = start;
  for (int k = 0; k < steps; ++k) {
    pose.position.z() = start.position.z() - 0.00005 * k;
    source.contacts_at(pose, contacts);
    proxy->compute({pose, Vec3::Zero()}, contacts, force);
    ASSERT_LE(deepest({pose.position + force.spring / config.stiffness, pose.axis, pose.roll}), 1e-9) << "step " << k;
  }
  EXPECT_GT(force.spring.z(), 0.0);
}

/// Downwards, leaning by half a radian at most.
inline Vec3 leaning_axis(Random& random) {
  return (Vec3(0, 0, -1) + 0.5 * random.direction()).normalized();
}

}  // namespace hapbench::test
