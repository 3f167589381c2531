#include "sim/tool/revolved.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>

namespace hapbench::meridian_test {
namespace {

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

TEST(Meridian, SaysWhichPointIsWrongAndWhy) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused("a profile needs", "two points", {{0, 1}});
  expect_refused("profile[1] = [nan, 1]", "finite", {{-2, 1}, {nan, 1}, {0, 1}});
  expect_refused("profile[1] = [0.5, 1]", "s has to be <= 0", {{-2, 1}, {0.5, 1}});
  expect_refused("profile[1] = [-1, -0.5]", "rho", {{-2, 1}, {-1, -0.5}, {0, 1}});
  expect_refused("profile[1] = [-1, 0]", "only the first and the last", {{-2, 1}, {-1, 0}, {0, 1}});
  expect_refused("profile[2] = [-1, 1]", "same as the point before", {{-2, 1}, {-1, 1}, {-1, 1}, {0, 1}});
  expect_refused("profile[1] = [-2, 1]", "from the shank's end to the tip", {{0, 1}, {-2, 1}});
  expect_refused("profile[1] = [-1, 1]", "goes back on itself", {{-2, 1}, {-1, 1}, {-1.5, 1}, {0, 2}});
  expect_refused("profile[2] = [0, 0.5]", "goes back on itself", {{-2, 1}, {0, 2}, {0, 0.5}, {0, 1}});
  expect_refused("profile[2]", "line from profile[0] to profile[1]", {{-3, 1}, {-1, 2}, {-2, 3}, {-2.5, 0.5}, {0, 1}});
  expect_refused("profile[1]", "disc that closes the shank's end", {{-2, 2}, {-1, 1}, {-3, 1}, {-3, 3}, {0, 3}});
  expect_refused("profile[1] = [-1, 1]", "beside it: s = 0", {{-2, 1}, {-1, 1}}, Tip::round);
  expect_refused("profile[1] = [0, 0]", "beside it: s = 0, rho > 0", {{-2, 1}, {0, 0}}, Tip::round);
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
  // A shank, a cone and a head: two corners inwards, with one of them a step.
  const Meridian meridian({{-9, 1}, {-4, 1}, {-3, 2}, {-3, 3}, {-1, 3}, {0, 2}}, Tip::flat);
  ASSERT_EQ(meridian.parts.size(), 3u);
  EXPECT_EQ(meridian.parts[2].low, -3);
  EXPECT_EQ(meridian.parts[2].high, 0);
  EXPECT_EQ(meridian.parts[2].last - meridian.parts[2].first, 2u);
}

}  // namespace
}  // namespace hapbench::meridian_test
