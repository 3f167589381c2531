#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/bits.hpp"
#include "tests/support/scenes.hpp"

namespace hapbench::normal_projection_test {
namespace {

/// Both kinds of normal projection differ from stiffness shaping in their depth models only.
class NormalProjectionLaw : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Both, NormalProjectionLaw,
                         testing::Values("normal_projection", "continuous_normal_projection"),
                         [](const auto& law) { return std::string(law.param); });

TEST_P(NormalProjectionLaw, IsStiffnessShapingOnItsDepthModelWithTheSameIterations) {
  for (const test::AnalyticScene& scene : test::analytic_scenes()) {
    for (const int m : {0, 3, 10}) {
      RenderingConfig projected = test::config_for(GetParam(), scene);
      projected.iterations = m;
      RenderingConfig shaped = projected;
      shaped.algorithm = "shaped_stiffness";
      shaped.depth_model = GetParam();  // depth model and law have the same name
      test::Probe a(scene.setting(), projected), b(scene.setting(), shaped);
      const RenderedForce force = a.force_at(scene.setting().pose);
      EXPECT_EQ(test::hash_of(force, a.contacts()), test::hash_of(b.force_at(scene.setting().pose), b.contacts()))
          << scene.name << " m = " << m;
    }
  }
}

}  // namespace
}  // namespace hapbench::normal_projection_test
