#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/input/input_error.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::time_step_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionTimeStep, OfASpringHasTheOrderOfItsIntegrator) {
  // Leapfrog with damping is of first order, rk4 of fourth; a fit over the coarse steps too is not quite there.
  const PrecisionResult leapfrog = kTimeStepStudy.run(bundled("single_spring"), quick());
  EXPECT_EQ(leapfrog.columns, (std::vector<std::string>{"step_s", "error_final_m", "error_rms_m", "error_max_m"}));
  ASSERT_EQ(leapfrog.rows.size(), 7u);
  EXPECT_NEAR(leapfrog.orders.front().order, 1.0, 0.15);
  const PrecisionResult rk4 = kTimeStepStudy.run(bundled("single_spring", {"integrator.type=rk4"}), quick());
  EXPECT_NEAR(rk4.orders.front().order, 4.0, 0.4);
  for (std::size_t row = 0; row < 7; ++row) {
    EXPECT_LT(value(rk4, row, "error_max_m"), value(leapfrog, row, "error_max_m"));
  }
}

TEST(PrecisionTimeStep, TakesAMeshAndAPlane) {
  for (const auto& [name, duration] : {std::pair{"poke_plane", "0.1"}, {"mesh_molar", "0.05"}}) {
    const PrecisionResult result =
        kTimeStepStudy.run(bundled(name, {std::string("time.duration_s=") + duration}), quick());
    ASSERT_EQ(result.rows.size(), 7u) << name;
    EXPECT_GT(value(result, 0, "error_rms_m"), value(result, 6, "error_rms_m")) << name;
    EXPECT_GT(value(result, 6, "error_rms_m"), 0.0) << name;
  }
}

TEST(PrecisionTimeStep, OfAPrescribedMotionComparesForces) {
  const PrecisionResult result = kTimeStepStudy.run(bundled("pure_rotation"), quick());
  EXPECT_EQ(result.columns, (std::vector<std::string>{"step_s", "error_final_N", "error_rms_N", "error_max_N"}));
  // The tip stands still, so that nothing but springs acts, which ask for poses alone: the same at common times.
  EXPECT_EQ(value(result, 0, "error_max_N"), 0.0);
}

TEST(PrecisionTimeStep, IsRefusedWhereItMeansNothing) {
  EXPECT_THROW(kTimeStepStudy.run(bundled("vertical_peg_in_hole_shaped_stiffness"), quick()), InputError)
      << "a simulated subject's noise has no limit";
  EXPECT_THROW(kTimeStepStudy.run(bundled("poke_plane", {R"(hand={"type":"none"})"}), quick()), InputError)
      << "no contact";
  EXPECT_THROW(kTimeStepStudy.run(bundled("single_spring", {"time.steps=7"}), quick()), InputError);
  EXPECT_THROW(kTimeStepStudy.run(bundled("single_spring", {"rendering.stiffness_N_per_m=1e12"}), quick()), InputError)
      << "the reference diverges";
}

}  // namespace
}  // namespace hapbench::time_step_test
