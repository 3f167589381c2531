#include <gtest/gtest.h>

#include <stdexcept>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::ideal_runs_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionSpacing, RefusesAnotherEnvironment) {
  EXPECT_THROW(kSpacingStudy.run(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(kAlgorithmsStudy.run(bundled("poke_plane"), quick()), InputError);
  EXPECT_THROW(
      kAlgorithmsStudy.run(bundled("drill_in_hole", {"tool.tip=round", "record.ideal_trajectory=false"}), quick()),
      InputError);
}

TEST(PrecisionAlgorithms, HaveARowEachAndTheThesissTwoOneWithAngularDamping) {
  const PrecisionResult result =
      kAlgorithmsStudy.run(bundled("task2_rotate_signed_distance", {"time.duration_s=0.5"}), quick());
  ASSERT_EQ(result.rows.size(), algorithms().size() + 7);  // two damped by the turn, five with the passivity controller
  const auto row_of = [&](const std::string& setting) -> const PrecisionRow& {
    for (const PrecisionRow& row : result.rows) {
      if (row.setting == setting) return row;
    }
    throw std::invalid_argument("no row " + setting);
  };
  // The drill leans towards the wall and back; what is damped at the wall instead of the tip differs.
  EXPECT_NE(row_of("shaped_stiffness").values, row_of("shaped_stiffness + angular_damping").values);
  EXPECT_NO_THROW(row_of("original_averaging + passivity_controller"));
  for (const PrecisionRow& row : result.rows) EXPECT_GT(row.seconds, 0.0) << row.setting;
}

}  // namespace
}  // namespace hapbench::ideal_runs_test
