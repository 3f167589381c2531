#include "algorithms/penalty_rendering.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "algorithms/registry.hpp"
#include "sim/geometry/analytic_shells.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::penalty_rendering_test {
namespace {

/// A flat tool 0.3 mm into a plane with a point every 0.1 mm.
test::Setting pressed_plane() {
  test::Setting setting;
  setting.points = surface_points(Plane{0.002, 0.0001});
  setting.cell_size = 0.0002;
  setting.pose.position = {0.00001, 0.00002, -0.0003};
  return setting;
}

test::Setting three_springs() {
  test::Setting setting;
  setting.springs = SpringSet{{{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}}, true};
  setting.pose.position = {0.001, -0.002, 0.0};
  return setting;
}

TEST(PenaltyRendering, DepthMaxIsTheDeepestCollidingPointBeforeAnyStage) {
  // The deepest point is merged with shallower ones of its cell, and the reduction keeps a single point.
  RenderingConfig config;
  test::Probe plain(pressed_plane(), config);
  const double depth = plain.force_at(pressed_plane().pose).depth_max;
  EXPECT_NEAR(depth, 0.0003, 1e-18);
  config.local_average = true;
  config.reduction = ReductionConfig{};
  test::Probe staged(pressed_plane(), config);
  EXPECT_EQ(staged.force_at(pressed_plane().pose).depth_max, depth);
  EXPECT_EQ(staged.contacts().size(), 1u);
}

TEST(PenaltyRendering, SpringsBringTheirOwnDepths) {
  for (const DepthModelEntry& model : depth_models()) {
    RenderingConfig config;
    config.algorithm = "summation";
    config.depth_model = model.info->name;
    test::Probe probe(three_springs(), config);
    // -K (2 x + y): the pair along x counts twice, the spring along -y is 2 mm deep.
    const Vec3 force = probe.force_at(three_springs().pose).spring;
    EXPECT_LE((force - Vec3(-40.0, 40.0, 0.0)).norm(), 1e-13);
    EXPECT_EQ(probe.contacts().depth[1], -0.001);
  }
}

TEST(PenaltyRendering, WantsTheAngularVelocityForAngularDampingOnly) {
  RenderingConfig config;
  config.angular_velocity_cutoff = 20.0;
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), std::nullopt);
  config.angular_damping = true;
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), 20.0);
  config.angular_velocity_cutoff.reset();
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), std::numeric_limits<double>::infinity());
  config.angular_velocity_cutoff = 5.0;
  config.passivity_controller = true;
  EXPECT_EQ(make_algorithm(config)->angular_velocity_cutoff(), 5.0);
}

TEST(PenaltyRendering, AngularDampingIsThatOfEveryContactAndFrictionThatOfTheirMean) {
  // Turned about y at 2 rad/s: omega x (x, y, z) = (2 z, 0, -2 x), u = -z, c = 1 / n, and the points lie z = 0.3 mm
  // above the tip. So v_n = -2 x_mean along z, and v_t = 2 z along x.
  RenderingConfig config;
  config.algorithm = "mean";
  config.damping = 10.0;
  config.angular_damping = true;
  config.mu_s = 5.0;
  test::Probe probe(pressed_plane(), config);
  const ToolPose pose = pressed_plane().pose;
  const RenderedForce force = probe.force_at(pose, Vec3::Zero(), {0.0, 2.0, 0.0});
  double mean_x = 0.0;
  for (std::size_t i = 0; i < probe.contacts().size(); ++i) mean_x += probe.contacts().x[i] - pose.position.x();
  mean_x /= static_cast<double>(probe.contacts().size());
  const Vec3 expected(-5.0 * 2.0 * 0.0003, 0.0, 10.0 * 2.0 * mean_x);
  EXPECT_LE((force.rendered - force.spring - expected).norm(), 1e-14);
  EXPECT_NE(mean_x, 0.0);
}

TEST(PenaltyRendering, CountsIterationsAndDroppedPointsUntilReset) {
  RenderingConfig config;
  config.iterations = 4;
  config.reduction = ReductionConfig{0.995, 1, {}};
  test::Probe probe(three_springs(), config);
  for (int step = 0; step < 3; ++step) probe.force_at(three_springs().pose);
  EXPECT_EQ(probe.algorithm().work().iterations, 12u);
  EXPECT_EQ(probe.algorithm().work().points_dropped, 6u);
  probe.algorithm().reset();
  EXPECT_EQ(probe.algorithm().work().iterations, 0u);
  EXPECT_EQ(probe.algorithm().work().points_dropped, 0u);
}

TEST(PenaltyRendering, LocalAverageNeedsAShellWithAGrid) {
  RenderingConfig config;
  config.local_average = true;
  EXPECT_THROW(test::Probe(three_springs(), config), std::invalid_argument);
  test::Setting without_grid = pressed_plane();
  without_grid.cell_size = 0.0;
  EXPECT_THROW(test::Probe(without_grid, config), std::invalid_argument);
}

}  // namespace
}  // namespace hapbench::penalty_rendering_test
