#include "results/record/stiffness_recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "results/allocations/allocations.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::stiffness_recorder_test {
namespace {

using test::cells_of;
using test::lines_of;
using test::read_file;
using test::TemporaryDirectory;

TEST(StiffnessRecorder, WritesTheTensorAndItsLargestEigenvalue) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()});
  StepRecord r = test::row(4, 0.002, contacts);
  r.force.S << 1, 2, 3,  //
      2, 5, 6,           //
      3, 6, 9;
  StiffnessRecorder recorder(dir / "stiffness_tensor.csv");
  recorder.on_step(r);
  recorder.finish();
  const auto lines = lines_of(read_file(dir / "stiffness_tensor.csv"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0], "step,time_s,sxx,sxy,sxz,syy,syz,szz,lambda_max");
  EXPECT_TRUE(lines[1].starts_with("4,0.002,1,2,3,5,6,9,")) << lines[1];
  // A root of det(S - lambda) = -lambda^3 + 15 lambda^2 - 10 lambda, the largest one. Rounding of an iterative solver
  // on entries below 10: some dozen eps of the norm, 15.
  EXPECT_NEAR(test::number_in(cells_of(lines[1]).at(8)), (15.0 + std::sqrt(185.0)) / 2.0, 1e-13);
}

TEST(StiffnessRecorder, WritesZerosWithoutContact) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  StiffnessRecorder recorder(dir / "stiffness_tensor.csv");
  recorder.on_step(test::row(0, 0.0, none));
  recorder.finish();
  EXPECT_EQ(lines_of(read_file(dir / "stiffness_tensor.csv")).at(1), "0,0,0,0,0,0,0,0,0");
}

TEST(StiffnessRecorder, KeepsEveryNthRowCountedFromTheFirst) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()});
  StiffnessRecorder recorder(dir / "stiffness_tensor.csv", 3);
  for (std::uint64_t k = 0; k < 7; ++k) recorder.on_step(test::row(k, 0.0, contacts));
  recorder.finish();
  const auto lines = lines_of(read_file(dir / "stiffness_tensor.csv"));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_TRUE(lines[3].starts_with("6,"));
}

TEST(StiffnessRecorder, AllocatesNothingInAStep) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()});
  StepRecord r = test::row(0, 0.0, contacts);
  r.force.S = Mat3::Identity() / 3.0;
  StiffnessRecorder recorder(dir / "stiffness_tensor.csv");
  const std::size_t before = heap_allocations();
  // Several times the file's buffer.
  for (int k = 0; k < 5000; ++k) recorder.on_step(r);
  EXPECT_EQ(heap_allocations(), before);
}

}  // namespace
}  // namespace hapbench::stiffness_recorder_test
