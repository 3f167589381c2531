#include "results/record/trajectory_recorder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "results/allocations/allocations.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::trajectory_recorder_test {
namespace {

using test::lines_of;
using test::read_file;
using test::TemporaryDirectory;

const std::string kColumns =
    "step,time_s,px_m,py_m,pz_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,axis_x,axis_y,axis_z,fx_N,fy_N,fz_N,fspring_x_N,"
    "fspring_y_N,fspring_z_N,fmeas_x_N,fmeas_y_N,fmeas_z_N,fin_x_N,fin_y_N,fin_z_N,hx_m,hy_m,hz_m,colliding,rendered,"
    "depth_max_m,ratio_min,ratio_max";

/// Every quantity different.
StepRecord full_row(const ContactBuffer& contacts) {
  StepRecord r = test::row(4, 0.002, contacts);
  r.tool = {{{1, 2, 3}, {7, 8, 9}}, {4, 5, 6}};
  r.force.rendered = {10, 11, 12};
  r.force.spring = {13, 14, 15};
  r.force.depth_max = 0.5;
  r.hand = {{16, 17, 18}, {19, 20, 21}};
  r.handle = {{22, 23, 24}, {-1, -1, -1}};
  r.colliding = 25;
  r.ratio = {0.75, 1.25};
  return r;
}

TEST(TrajectoryRecorder, WritesTheDocumentedColumnsInOrder) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitY()});
  TrajectoryRecorder recorder(dir / "trajectory.csv");
  recorder.on_step(full_row(contacts));
  recorder.finish();
  EXPECT_EQ(read_file(dir / "trajectory.csv"),
            kColumns + "\n4,0.002,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,2,0.5,0.75,1.25\n");
}

TEST(TrajectoryRecorder, LeavesTheRatioEmptyWhenNothingIsRendered) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  TrajectoryRecorder recorder(dir / "trajectory.csv");
  recorder.on_step(test::row(0, 0.0, none));
  recorder.finish();
  EXPECT_TRUE(lines_of(read_file(dir / "trajectory.csv")).at(1).ends_with(",0,0,0,,"));
}

TEST(TrajectoryRecorder, AsksForTheRatio) {
  const TemporaryDirectory dir;
  EXPECT_TRUE(TrajectoryRecorder(dir / "trajectory.csv").wants_ratio());
}

TEST(TrajectoryRecorder, KeepsEveryNthRowCountedFromTheFirst) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  TrajectoryRecorder recorder(dir / "trajectory.csv", 3);
  for (std::uint64_t k = 0; k < 8; ++k) recorder.on_step(test::row(k, 0.0, none));
  recorder.finish();
  const auto lines = lines_of(read_file(dir / "trajectory.csv"));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_TRUE(lines[1].starts_with("0,"));
  EXPECT_TRUE(lines[2].starts_with("3,"));
  EXPECT_TRUE(lines[3].starts_with("6,"));
}

TEST(TrajectoryRecorder, AllocatesNothingInAStep) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()});
  TrajectoryRecorder recorder(dir / "trajectory.csv");
  const StepRecord r = full_row(contacts);
  const std::size_t before = heap_allocations();
  // Several times the file's buffer.
  for (int k = 0; k < 5000; ++k) recorder.on_step(r);
  EXPECT_EQ(heap_allocations(), before);
}

TEST(TrajectoryRecorder, ThatIsNeverFinishedLeavesNoFile) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  {
    TrajectoryRecorder recorder(dir / "trajectory.csv");
    recorder.on_step(test::row(0, 0.0, none));
  }
  EXPECT_TRUE(dir.entries().empty());
}

TEST(TrajectoryRecorder, AddsPoseAndTorqueAfterTheUsualColumns) {
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitY()});
  StepRecord r = full_row(contacts);
  r.tool.pose.axis = {0, 0, -1};
  r.roll = std::numbers::pi / 3;
  r.springs.moment = {0.5, -0.25, 0.125};
  const auto written = [&r](const TrajectoryExtras& extras) {
    const TemporaryDirectory dir;
    TrajectoryRecorder recorder(dir / "trajectory.csv", 1, extras);
    EXPECT_EQ(recorder.wants_roll(), extras.pose);
    EXPECT_EQ(recorder.wants_springs(), extras.torque);
    recorder.on_step(r);
    recorder.finish();
    return lines_of(read_file(dir / "trajectory.csv"));
  };
  const auto usual = written({}), pose = written({true, false}), torque = written({false, true}),
             both = written({true, true});
  EXPECT_EQ(usual.at(0), kColumns);
  EXPECT_EQ(pose.at(0), kColumns + ",qw,qx,qy,qz");
  EXPECT_EQ(torque.at(0), kColumns + ",tx_Nm,ty_Nm,tz_Nm");
  EXPECT_EQ(torque.at(1), usual.at(1) + ",0.5,-0.25,0.125");
  EXPECT_EQ(both.at(0), kColumns + ",qw,qx,qy,qz,tx_Nm,ty_Nm,tz_Nm");
  EXPECT_EQ(both.at(1), pose.at(1) + ",0.5,-0.25,0.125");
  // Right-handed about -z by 60 degrees.
  double q[4] = {};
  ASSERT_EQ(std::sscanf(pose.at(1).c_str() + usual.at(1).size(), ",%lf,%lf,%lf,%lf", q, q + 1, q + 2, q + 3), 4);
  const double expected[] = {std::sqrt(0.75), 0.0, 0.0, -0.5};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(q[i], expected[i], 1e-15) << i;
}

TEST(TrajectoryRecorder, WritesTheQuaternionWhoseFirstNumberIsNotNegative) {
  const ContactBuffer none(1);
  const TemporaryDirectory dir;
  TrajectoryRecorder recorder(dir / "trajectory.csv", 1, {true, false});
  std::uint64_t step = 0;
  for (const double roll : {-3.5, -2.0, 2.0, 3.5, 5.0}) {
    StepRecord r = test::row(step++, 0.0, none);
    r.roll = roll;
    recorder.on_step(r);
  }
  recorder.finish();
  const auto lines = lines_of(read_file(dir / "trajectory.csv"));
  for (std::size_t i = 1; i < lines.size(); ++i) EXPECT_NE(lines[i].find(",,,0."), std::string::npos) << lines[i];
}

}  // namespace
}  // namespace hapbench::trajectory_recorder_test
