#include "results/record/ideal_trajectory_recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "results/allocations/allocations.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::ideal_trajectory_recorder_test {
namespace {

using test::TemporaryDirectory;

StepRecord tilted_row(std::uint64_t step, double tilt, const ContactBuffer& contacts) {
  StepRecord r = test::row(step, 0.0, contacts);
  r.tool.pose = {{0, 0, -0.001}, {-std::sin(tilt), 0, -std::cos(tilt)}};
  return r;
}

TEST(IdealTrajectoryRecorder, KeepsTheRowsThatHaveAnIdealPlace) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  IdealTrajectoryObserver observer({}, {}, 2);
  IdealTrajectoryRecorder recorder(dir / "ideal.csv", observer);
  const double tilts[] = {0.5, 0.6, 1.3, 0.7, 0.8};
  for (std::uint64_t k = 0; k < 5; ++k) {
    const StepRecord r = tilted_row(k, tilts[k], none);
    observer.on_step(r);
    recorder.on_step(r);
  }
  recorder.finish();
  const auto lines = test::lines_of(test::read_file(dir / "ideal.csv"));
  ASSERT_EQ(lines.size(), 3u) << "rows 0 and 4; 1 and 3 lie between, 2 is too steep";
  EXPECT_EQ(lines[0], header_of(IdealTrajectoryRecorder::kColumns));
  EXPECT_TRUE(lines[1].starts_with("0,0,0.5,-0.001,"));
  EXPECT_TRUE(lines[2].starts_with("4,"));
}

TEST(IdealTrajectoryRecorder, AllocatesNothingInAStep) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  IdealTrajectoryObserver observer({}, {});
  IdealTrajectoryRecorder recorder(dir / "ideal.csv", observer);
  const StepRecord r = tilted_row(0, 0.5, none);
  const std::size_t before = heap_allocations();
  for (int k = 0; k < 100; ++k) {
    observer.on_step(r);
    recorder.on_step(r);
  }
  EXPECT_EQ(heap_allocations(), before);
}

}  // namespace
}  // namespace hapbench::ideal_trajectory_recorder_test
