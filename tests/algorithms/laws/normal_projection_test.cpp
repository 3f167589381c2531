#include "algorithms/laws/normal_projection.hpp"

#include <gtest/gtest.h>

#include "algorithms/laws/continuous_normal_projection.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench {
namespace {

/// The laws of both kinds of normal projection, which differ in their depth models only.
class NormalProjectionLaw : public testing::TestWithParam<decltype(&make_normal_projection)> {};
INSTANTIATE_TEST_SUITE_P(Both, NormalProjectionLaw,
                         testing::Values(make_normal_projection, make_continuous_normal_projection),
                         [](const auto& law) { return law.index == 0 ? "plain" : "continuous"; });

TEST_P(NormalProjectionLaw, IsStiffnessShapingWithTheSameIterations) {
  Random random(1);
  for (const int m : {0, 3, 10}) {
    RenderingConfig config;
    config.iterations = m;
    std::vector<Vec3> gradients(30);
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer a = test::contacts_of(gradients, test::random_depths(random, 30)), b = a;
    const LawForce projected = GetParam()(config)->evaluate(a);
    const LawForce shaped = make_shaped_stiffness(config)->evaluate(b);
    EXPECT_EQ(projected.spring, shaped.spring);
    EXPECT_EQ(projected.S, shaped.S);
    EXPECT_EQ(test::hash_of(a), test::hash_of(b));
  }
}

}  // namespace
}  // namespace hapbench
