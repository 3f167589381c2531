#include "sim/tool/bur.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/tool/revolved.hpp"

namespace hapbench::bur_test {
namespace {

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
    // Of a ball the neck cuts a little off.
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
  // Smooth: from the shank on no corner of pear and flame but the tip's, the shank's and the flame's waist turns by
  // more than a chord does.
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
}  // namespace hapbench::bur_test
