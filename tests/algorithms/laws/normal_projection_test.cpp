#include "algorithms/laws/normal_projection.hpp"

#include <gtest/gtest.h>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench {
namespace {

TEST(NormalProjectionLaw, IsStiffnessShapingWithTheSameIterations) {
  Random random(1);
  for (const int m : {0, 3, 10}) {
    RenderingConfig config;
    config.iterations = m;
    std::vector<Vec3> gradients(30);
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer a = test::contacts_of(gradients, test::random_depths(random, 30)), b = a;
    const LawForce projected = make_normal_projection(config)->evaluate(a);
    const LawForce shaped = make_shaped_stiffness(config)->evaluate(b);
    EXPECT_EQ(projected.spring, shaped.spring);
    EXPECT_EQ(projected.S, shaped.S);
    EXPECT_EQ(test::hash_of(a), test::hash_of(b));
  }
}

}  // namespace
}  // namespace hapbench
