#include "sim/tool/cylinder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/random.hpp"
#include "tests/support/scale.hpp"

/// Properties of cylinders alone; EveryTool tests those of any tool.
namespace hapbench::cylinder_test {
namespace {

using test::cases;

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

TEST(CylinderConstraints, OnTheAxisTakeSomeNearestPlace) {
  const Cylinder tool{0.0005, 0.01, Tip::flat};
  ContactBuffer contacts(2);
  for (const double height : {0.005, 0.0001}) contacts.push(0, {0, 0, height}, Vec3::UnitZ());
  tool.surface_constraints({}, Vec3::Zero(), 0.0, contacts);
  EXPECT_EQ(contacts.depth[0], 0.0005);
  EXPECT_NEAR(contacts.gradient(0).norm(), 1.0, 1e-15);
  EXPECT_EQ(contacts.gradient(0).z(), 0.0);
  EXPECT_EQ(contacts.depth[1], 0.0001);
  EXPECT_EQ(contacts.gradient(1), Vec3(-Vec3::UnitZ()));
}

}  // namespace
}  // namespace hapbench::cylinder_test
