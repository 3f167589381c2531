#include "sim/tool/cylinder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "tests/support/scale.hpp"
#include "tests/support/tool_geometry.hpp"

namespace hapbench::cylinder_test {
namespace {

using test::cases;

/// Coordinates of up to 1 m are rounded to 1e-16 of themselves, a few times over.
constexpr double kRounding = 4e-15;

class CylinderOfTip : public testing::TestWithParam<Tip> {};
INSTANTIATE_TEST_SUITE_P(BothTips, CylinderOfTip, testing::Values(Tip::flat, Tip::round),
                         [](const auto& tip) { return tip.param == Tip::flat ? "flat" : "round"; });

/// Eight points as the searches hand them over.
class Pack {
 public:
  explicit Pack(const std::array<Vec3, 8>& points) : x_(8), y_(8), z_(8) {
    for (std::size_t i = 0; i < 8; ++i)
      std::tie(x_[i], y_[i], z_[i]) = std::tuple(points[i].x(), points[i].y(), points[i].z());
  }
  PointArrays arrays() const { return {x_.data(), y_.data(), z_.data()}; }

 private:
  AlignedDoubles x_, y_, z_;
};

constexpr PackRange kOnePack{0, 1};

TEST_P(CylinderOfTip, MarksAsNearWhateverLiesWithinTheMargin) {
  Random random(1);
  std::size_t near = 0;
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const double margin = tool.radius() * random.uniform();
    std::array<Vec3, 8> points;
    for (Vec3& point : points) {
      point = test::random_point_on(tool, pose, random) + margin * std::cbrt(random.uniform()) * random.direction();
    }
    std::uint8_t marks = 0;
    tool.mark_near(pose, margin + kRounding, Pack(points).arrays(), {&kOnePack, 1}, &marks);
    ASSERT_EQ(marks, 0xff);
    const Box all{Vec3::Constant(-2.0), Vec3::Constant(2.0)};
    const Box box = tool.box_near(pose, margin + kRounding, all);
    for (const Vec3& point : points) {
      ASSERT_TRUE((point.array() >= box.min.array()).all() && (point.array() <= box.max.array()).all());
      near += test::slack(tool, pose, point.cast<long double>()) < 0.0L;
    }
  }
  EXPECT_GT(near, cases(5000));
}

TEST_P(CylinderOfTip, MovesNoPointOfItsBodyFurtherThanItSays) {
  Random random(2);
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose from = test::random_pose(random);
    const double turn = std::pow(10.0, random.uniform(-6.0, 0.0));
    const ToolPose to{from.position + turn * 1e-3 * random.direction(),
                      (from.axis + turn * random.direction()).normalized(), random.uniform(-3.0, 3.0)};
    const double moved = tool.moved_at_most(from, to);
    const Vec3 point = test::random_point_on(tool, to, random);
    // Within `moved` of where the body was, so the body grown by as much has it.
    std::uint8_t marks = 0;
    tool.mark_near(from, moved + kRounding, Pack({point, point, point, point, point, point, point, point}).arrays(),
                   {&kOnePack, 1}, &marks);
    ASSERT_EQ(marks, 0xff);
  }
}

TEST_P(CylinderOfTip, HasItsForemostPlaceOnTheSurfaceAndNoneBeyondIt) {
  Random random(3);
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const Vec3 normal = random.direction();
    ContactBuffer contacts(1);
    contacts.push(0, test::random_point_near(tool, pose, random), normal);
    alignas(64) double x[simd::lanes], y[simd::lanes], z[simd::lanes];
    tool.foremost_places(pose, contacts, {x, y, z});
    const Vec3 place(x[0], y[0], z[0]);
    EXPECT_NEAR(static_cast<double>(test::slack(tool, pose, place.cast<long double>())), 0.0, kRounding);
    for (int k = 0; k < 20; ++k) {
      EXPECT_GE((test::random_point_on(tool, pose, random) - place).dot(normal), -kRounding);
    }
  }
}

TEST_P(CylinderOfTip, GrownHoldsEveryPointWithinTheMargin) {
  Random random(4);
  for (std::size_t i = 0; i < cases(5000); ++i) {
    const Cylinder tool = test::random_tool(random, GetParam());
    const ToolPose pose = test::random_pose(random);
    const double margin = tool.radius() * random.uniform();
    const ToolShape::Grown grown = tool.grown(margin + kRounding);
    const ToolPose ahead{pose.position + grown.forward * pose.axis, pose.axis, pose.roll};
    std::array<Vec3, 8> points;
    for (Vec3& point : points) {
      point = test::random_point_on(tool, pose, random) + margin * random.uniform() * random.direction();
    }
    std::uint8_t marks = 0;
    grown.shape->mark_inside(ahead, Pack(points).arrays(), {&kOnePack, 1}, &marks);
    ASSERT_EQ(marks, 0xff);
  }
}

TEST(LargestSquareWithin, IsTheLastSquareWhoseRootDoesNotExceedTheRadius) {
  Random random(3);
  constexpr double up = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < cases(100000); ++i) {
    const double r = std::pow(10.0, random.uniform(-9.0, 3.0));
    const double square = largest_square_within(r);
    ASSERT_LE(std::sqrt(square), r);
    ASSERT_GT(std::sqrt(std::nextafter(square, up)), r);
  }
}

}  // namespace
}  // namespace hapbench::cylinder_test
