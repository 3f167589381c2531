#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/random.hpp"
#include "sim/tool/bur_profile.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/revolved.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::revolved_test {
namespace {

using test::cases;

// Tests properties that only cylinders and solids of revolution have; EveryTool tests the properties of all tools.

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

TEST(CylinderConstraints, OnTheAxisTakeSomeNearestPoint) {
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

/// Returns how many of the first sixteen points are inside the tool.
std::size_t inside(const ToolShape& tool, const ToolPose& pose, const ContactBuffer& contacts) {
  ContactBuffer found(16);
  tool.push_inside(pose,
                   {contacts.index.data(), contacts.x.data(), contacts.y.data(), contacts.z.data(), contacts.nx.data(),
                    contacts.ny.data(), contacts.nz.data()},
                   2, found);
  return found.size();
}

TEST(Revolved, PointsOnItsSurfaceCollideWithDepthZero) {
  // Dyadic numbers and a pose along an axis: every coordinate is exact.
  const double u = 0x1p-13;
  const Revolved tool(
      {{-16 * u, 2 * u}, {-8 * u, 2 * u}, {-12 * u, 6 * u}, {-4 * u, 6 * u}, {-4 * u, 3 * u}, {0, 3 * u}});
  ContactBuffer contacts(16);
  const auto add = [&](double s, double rho) { contacts.push(0, u * Vec3(rho, 0.0, -s), Vec3::UnitZ()); };
  add(-16, 1), add(-16, 2), add(-12, 2), add(-8, 2), add(-6, 6), add(-4, 6), add(-4, 4), add(-4, 3), add(-2, 3),
      add(0, 1);
  for (std::size_t i = contacts.size(); i < 16; ++i) contacts.x[i] = 1.0;
  EXPECT_EQ(inside(tool, {}, contacts), contacts.size());
  tool.shortest_depths({}, contacts);
  for (std::size_t i = 0; i < contacts.size(); ++i) EXPECT_EQ(contacts.depth[i], 0.0) << i;
}

TEST(Revolved, FallsBackToTheInwardNormalWhereNoPointIsNearest) {
  const Revolved tool({{-0.01, 0.0005}, {-0.005, 0.0008}, {0.0, 0.0005}});
  const Vec3 normal = Vec3(3, 4, 0) / 5;
  ContactBuffer contacts(1);
  contacts.push(0, {0, 0, 0.005}, normal);
  tool.shortest_gradients({}, contacts);
  EXPECT_EQ(contacts.gradient(0), Vec3(-normal));
}

TEST(Revolved, OfAPoseThatIsNotFiniteHoldsNothing) {
  for (const Tip tip : {Tip::flat, Tip::round}) {
    const Revolved tool({{-0.01, 0.0005}, {-0.005, 0.0003}, {0.0, 0.0005}}, tip);
    ContactBuffer contacts(16);
    for (std::uint32_t i = 0; i < 16; ++i) contacts.push(i, {0, 0, 0.001}, Vec3::UnitZ());
    EXPECT_EQ(inside(tool, {}, contacts), 16u);
    for (const double bad : {std::nan(""), HUGE_VAL}) {
      EXPECT_EQ(inside(tool, {{bad, 0, 0}, {0, 0, -1}}, contacts), 0u);
      EXPECT_EQ(inside(tool, {{0, 0, 0}, {0, bad, -1}}, contacts), 0u);
    }
  }
}

std::string refused(std::vector<ProfilePoint> points, Tip tip = Tip::flat) {
  try {
    Meridian(std::move(points), tip);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "accepted";
}

void expect_refused(const std::string& start, const std::string& about, std::vector<ProfilePoint> points,
                    Tip tip = Tip::flat) {
  const std::string what = refused(std::move(points), tip);
  EXPECT_EQ(what.substr(0, start.size()), start);
  EXPECT_NE(what.find(about), std::string::npos) << what;
}

TEST(Meridian, NamesThePointThatIsWrongAndWhy) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused("a profile needs", "two points", {{0, 1}});
  expect_refused("profile[1] = [nan, 1]", "finite", {{-2, 1}, {nan, 1}, {0, 1}});
  expect_refused("profile[1] = [0.5, 1]", "s must be <= 0", {{-2, 1}, {0.5, 1}});
  expect_refused("profile[1] = [-1, -0.5]", "rho", {{-2, 1}, {-1, -0.5}, {0, 1}});
  expect_refused("profile[1] = [-1, 0]", "only the first and the last", {{-2, 1}, {-1, 0}, {0, 1}});
  expect_refused("profile[2] = [-1, 1]", "equal to the previous point", {{-2, 1}, {-1, 1}, {-1, 1}, {0, 1}});
  expect_refused("profile[1] = [-2, 1]", "from the shank's end to the tip", {{0, 1}, {-2, 1}});
  expect_refused("profile[1] = [-1, 1]", "reverses onto itself", {{-2, 1}, {-1, 1}, {-1.5, 1}, {0, 2}});
  expect_refused("profile[2] = [0, 0.5]", "reverses onto itself", {{-2, 1}, {0, 2}, {0, 0.5}, {0, 1}});
  expect_refused("profile[2]", "line from profile[0] to profile[1]", {{-3, 1}, {-1, 2}, {-2, 3}, {-2.5, 0.5}, {0, 1}});
  expect_refused("profile[1]", "disc that closes the shank's end", {{-2, 2}, {-1, 1}, {-3, 1}, {-3, 3}, {0, 3}});
  expect_refused("profile[1] = [-1, 1]", "must end at s = 0", {{-2, 1}, {-1, 1}}, Tip::round);
  expect_refused("profile[1] = [0, 0]", "must end at s = 0 with rho > 0", {{-2, 1}, {0, 0}}, Tip::round);
  expect_refused("profile[1] = [0, 0]", "no body", {{-2, 0}, {0, 0}});
}

TEST(Meridian, TakesWhateverDoesNotMeetItself) {
  EXPECT_EQ(refused({{-2, 1}, {0, 1}}), "accepted");
  EXPECT_EQ(refused({{-2, 0}, {-1, 1}, {0, 0}}), "accepted");
  EXPECT_EQ(refused({{-3, 1}, {-1, 1}, {-2, 2}, {0, 2}}), "accepted") << "undercut";
  EXPECT_EQ(refused({{-3, 1}, {0, 1}, {-1, 0}}), "accepted") << "hollow tip";
  EXPECT_EQ(refused({{-3, 1}, {0, 1}, {0, 2}}, Tip::round), "accepted") << "a half ball wider than its shank";
  EXPECT_EQ(refused({{-3, 1}, {-1, 1}, {-1, 2}, {0, 2}, {0, 1}}, Tip::round), "accepted") << "a narrower one";
}

TEST(Meridian, KnowsWhetherTheBodyIsConvex) {
  const auto convex = [](std::vector<ProfilePoint> points, Tip tip = Tip::flat) {
    return Meridian(std::move(points), tip).convex;
  };
  EXPECT_TRUE(convex({{-2, 1}, {0, 1}}));
  EXPECT_TRUE(convex({{-2, 1}, {-1, 1}, {0, 1}})) << "straight";
  EXPECT_TRUE(convex({{-2, 1}, {0, 1}}, Tip::round));
  EXPECT_TRUE(convex({{-2, 0.5}, {0, 1}}, Tip::round));
  EXPECT_TRUE(convex({{-2, 0}, {-1, 1}, {0, 0}}));
  EXPECT_TRUE(convex({{-2, 0.5}, {-2, 1}, {0, 1}, {0, 0.5}})) << "points on the discs";
  EXPECT_FALSE(convex({{-2, 1}, {-1, 0.5}, {0, 1}}));
  EXPECT_FALSE(convex({{-2, 1}, {-1, 1}, {-1, 0.5}, {0, 0.5}})) << "a step";
  EXPECT_FALSE(convex({{-2, 1}, {0, 0.5}}, Tip::round)) << "it narrows towards the ball";
  EXPECT_FALSE(convex({{-2, 0.5}, {0, 0.5}, {0, 1}}, Tip::round));
  EXPECT_FALSE(convex({{-3, 1}, {0, 1}, {-1, 0}})) << "hollow tip";
}

TEST(Meridian, CutsTheSectionAtCornersThatTurnInwards) {
  // The profile has a shank, a cone and a head. It turns inwards at two corners: between shank and cone, and between
  // cone and head, where the radius jumps.
  const Meridian meridian({{-9, 1}, {-4, 1}, {-3, 2}, {-3, 3}, {-1, 3}, {0, 2}}, Tip::flat);
  ASSERT_EQ(meridian.parts.size(), 3u);
  EXPECT_EQ(meridian.parts[2].low, -3);
  EXPECT_EQ(meridian.parts[2].high, 0);
  EXPECT_EQ(meridian.parts[2].last - meridian.parts[2].first, 2u);
}

constexpr BurFamily kFamilies[] = {BurFamily::ball,    BurFamily::cylinder,      BurFamily::round_cylinder,
                                   BurFamily::tapered, BurFamily::inverted_cone, BurFamily::pear,
                                   BurFamily::flame};

double length_of(BurFamily family) {
  return family == BurFamily::ball ? 0.001 : 0.003;
}

TEST(BurProfile, HasTheDiameterTheLengthAndTheShankItIsAskedFor) {
  for (const BurFamily family : kFamilies) {
    SCOPED_TRACE(static_cast<int>(family));
    const BurProfile bur = bur_profile(family, 0.001, length_of(family), 0.0004);
    const Revolved tool(bur.profile, bur.tip);
    EXPECT_NEAR(tool.half_width(), 0.0005, 1e-18);
    const auto& p = bur.profile;
    EXPECT_EQ(p[0].rho, 0.0002);
    EXPECT_EQ(p[1].rho, 0.0002);
    EXPECT_NEAR(p[1].s - p[0].s, 0.004, 1e-17);
    // The neck cuts a small part off the ball.
    const double cut = family == BurFamily::ball ? 0.0005 - std::sqrt(0.0005 * 0.0005 - 0.0002 * 0.0002) : 0.0;
    const double foremost = bur.tip == Tip::round ? p.back().rho : p.back().s;
    EXPECT_NEAR(foremost - p[1].s, length_of(family) - cut, 1e-17);
    EXPECT_FALSE(tool.convex());
  }
}

TEST(BurProfile, WithoutAStepOfTheShankIsConvexWhereItCanBe) {
  const BurProfile bur = bur_profile(BurFamily::round_cylinder, 0.001, 0.003, 0.001);
  EXPECT_TRUE(Revolved(bur.profile, bur.tip).convex());
}

TEST(BurProfile, KeepsAThousandthOfTheDiameterToItsArcs) {
  const BurProfile ball = bur_profile(BurFamily::ball, 0.001, 0.001, 0.0003);
  for (std::size_t i = 1; i + 1 < ball.profile.size(); ++i) {
    const ProfilePoint a = ball.profile[i], b = ball.profile[i + 1];
    EXPECT_NEAR(std::hypot(a.s, a.rho), 0.0005, 1e-18);
    EXPECT_GE(std::hypot(0.5 * (a.s + b.s), 0.5 * (a.rho + b.rho)), 0.0005 - 1e-6);
  }
  // Between the corner of the shank and the tip, the outlines of pear and flame are convex, and no corner turns by more
  // than the arc of one chord.
  for (const BurFamily family : {BurFamily::pear, BurFamily::flame}) {
    const BurProfile bur = bur_profile(family, 0.001, 0.003, 0.0004);
    for (std::size_t i = 2; i + 1 < bur.profile.size(); ++i) {
      const ProfilePoint a = bur.profile[i - 1], b = bur.profile[i], c = bur.profile[i + 1];
      const double turn = std::atan2(c.rho - b.rho, c.s - b.s) - std::atan2(b.rho - a.rho, b.s - a.s);
      EXPECT_LE(turn, 1e-9) << i;
      EXPECT_GE(turn, -2.0 * std::acos(1.0 - 0.002)) << i;
    }
  }
}

TEST(BurProfile, RefusesLengthsThatDoNotSuitTheFamily) {
  EXPECT_THROW(bur_profile(BurFamily::cylinder, 0.0, 0.003, 0.0004), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::cylinder, 0.001, -0.003, 0.0004), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::cylinder, 0.001, 0.003, std::nan("")), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::ball, 0.001, 0.002, 0.0004), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::ball, 0.001, 0.001, 0.001), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::round_cylinder, 0.001, 0.0004, 0.0004), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::pear, 0.001, 0.0009, 0.0004), std::invalid_argument);
  EXPECT_THROW(bur_profile(BurFamily::flame, 0.001, 0.0008, 0.0004), std::invalid_argument);
}

}  // namespace
}  // namespace hapbench::revolved_test
