#include "sim/contact/grid_index.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numeric>

#include "sim/mesh/marching_cubes.hpp"
#include "tests/support/brick.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_geometry.hpp"

namespace hapbench::most_points_test {
namespace {

using test::cases;

std::size_t marked_near(const PointShell& shell, const ToolShape& tool, const ToolPose& pose, double margin) {
  const PackRange all{0, shell.padded_size() / simd::lanes};
  std::vector<std::uint8_t> marks(all.last);
  tool.mark_near(pose, margin, {shell.x(), shell.y(), shell.z()}, {&all, 1}, marks.data());
  return std::accumulate(marks.begin(), marks.end(), std::size_t{0}, [](std::size_t n, std::uint8_t mark) {
    return n + static_cast<std::size_t>(std::popcount(mark));
  });
}

/// How many points of a random shell the tool has near it, at worst over some poses, as a part of the bound.
double worst_part_of_bound(const ToolShape& tool, double size, Random& random) {
  const double margin = random.uniform(0.0, 0.3) * tool.half_width();
  const PointShell shell(test::random_shell(random, size), 0.0);
  const std::size_t bound = most_points_in(shell, tool.cover(margin));
  EXPECT_LE(bound, shell.size());
  ToolPose pose{Vec3::Zero(), random.direction()};
  std::size_t worst = 0;
  for (int k = 0; k < 50; ++k) {
    pose = test::next_pose(pose, random, size, 0.2 * tool.half_width());
    worst = std::max(worst, marked_near(shell, tool, pose, margin));
  }
  EXPECT_LE(worst, bound);
  return static_cast<double>(worst) / static_cast<double>(std::max<std::size_t>(1, bound));
}

TEST(MostPoints, BoundWhatAnyToolHasNearItAnywhere) {
  Random random(5);
  double tightest = 0.0;
  for (std::size_t i = 0; i < cases(2000); ++i) {
    const double size = std::pow(10.0, random.uniform(-4.0, 0.0));
    const Tip tip = random.below(2) == 0 ? Tip::flat : Tip::round;
    const Cylinder drill{size * random.uniform(0.01, 0.2), size * random.uniform(0.02, 3.0), tip};
    tightest = std::max(tightest, worst_part_of_bound(drill, size, random));
    const test::Brick brick(size * random.uniform(0.01, 0.2), size * random.uniform(0.01, 0.2),
                            size * random.uniform(0.02, 0.5));
    tightest = std::max(tightest, worst_part_of_bound(brick, size, random));
  }
  EXPECT_GT(tightest, 0.5);  // the walks come close to what is bounded
}

TEST(MostPoints, AreFewOfTheThesissBlock) {
  const std::vector<SurfacePoint> points =
      marching_cubes(density_field(BlockWithHole(), 0.0001, Density::signed_distance)).vertices;
  const PointShell shell(points, 0.0001);
  const Cylinder drill;
  // 440 in the hole, 1000 along a wall; eight balls and the hole's 2 000 points in a cube around each.
  const std::size_t bound = most_points_in(shell, drill.cover(0.0));
  EXPECT_GT(bound, 1000u);
  EXPECT_LT(bound, shell.size() / 4);
}

TEST(MostPoints, AreNoneOfAnEmptyShell) {
  EXPECT_EQ(most_points_in(PointShell({}, 0.1), Cylinder().cover(0.0)), 0u);
}

}  // namespace
}  // namespace hapbench::most_points_test
