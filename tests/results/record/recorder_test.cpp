#include "results/record/recorder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "results/allocations/allocations.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::recorder_test {
namespace {

using test::cells_of;
using test::lines_of;
using test::number_in;
using test::read_file;
using test::TemporaryDirectory;

const std::string kTrajectoryColumns =
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
  Recorder recorder(dir / "trajectory.csv", trajectory_rows());
  recorder.on_step(full_row(contacts));
  recorder.finish();
  EXPECT_EQ(read_file(dir / "trajectory.csv"),
            kTrajectoryColumns +
                "\n4,0.002,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17,18,19,20,21,22,23,24,25,2,0.5,0.75,1.25\n");
}

TEST(TrajectoryRecorder, LeavesTheRatioEmptyWhenNothingIsRendered) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  Recorder recorder(dir / "trajectory.csv", trajectory_rows());
  recorder.on_step(test::row(0, 0.0, none));
  recorder.finish();
  EXPECT_TRUE(lines_of(read_file(dir / "trajectory.csv")).at(1).ends_with(",0,0,0,,"));
}

TEST(TrajectoryRecorder, KeepsEveryNthRowCountedFromTheFirst) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  Recorder recorder(dir / "trajectory.csv", trajectory_rows(), 3);
  for (std::uint64_t k = 0; k < 8; ++k) recorder.on_step(test::row(k, 0.0, none));
  recorder.finish();
  const auto lines = lines_of(read_file(dir / "trajectory.csv"));
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_TRUE(lines[1].starts_with("0,"));
  EXPECT_TRUE(lines[2].starts_with("3,"));
  EXPECT_TRUE(lines[3].starts_with("6,"));
}

TEST(TrajectoryRecorder, AddsPoseAndTorqueAfterTheUsualColumns) {
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitY()});
  StepRecord r = full_row(contacts);
  r.tool.pose.axis = {0, 0, -1};
  r.roll = std::numbers::pi / 3;
  r.springs.moment = {0.5, -0.25, 0.125};
  const auto written = [&r](const TrajectoryExtras& extras) {
    const TemporaryDirectory dir;
    Recorder recorder(dir / "trajectory.csv", trajectory_rows(extras));
    EXPECT_EQ(recorder.wants_roll(), extras.pose);
    EXPECT_EQ(recorder.wants_springs(), extras.torque);
    recorder.on_step(r);
    recorder.finish();
    return lines_of(read_file(dir / "trajectory.csv"));
  };
  const auto usual = written({}), pose = written({true, false}), torque = written({false, true}),
             both = written({true, true});
  EXPECT_EQ(usual.at(0), kTrajectoryColumns);
  EXPECT_EQ(pose.at(0), kTrajectoryColumns + ",qw,qx,qy,qz");
  EXPECT_EQ(torque.at(0), kTrajectoryColumns + ",tx_Nm,ty_Nm,tz_Nm");
  EXPECT_EQ(torque.at(1), usual.at(1) + ",0.5,-0.25,0.125");
  EXPECT_EQ(both.at(0), kTrajectoryColumns + ",qw,qx,qy,qz,tx_Nm,ty_Nm,tz_Nm");
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
  Recorder recorder(dir / "trajectory.csv", trajectory_rows({.pose = true}));
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

const std::string kContactColumns =
    "step,time_s,index,x_m,y_m,z_m,nx,ny,nz,depth_m,gradient_x,gradient_y,gradient_z,weight";

TEST(ContactRecorder, WritesOneLineForEachRenderedContact) {
  const TemporaryDirectory dir;
  ContactBuffer contacts = test::contacts_along({{1, 2, 3}, {4, 5, 6}});
  contacts.depth[1] = 0.002;
  contacts.weight[1] = 0.5;
  Recorder recorder(dir / "contacts.csv", contact_rows());
  recorder.on_step(test::row(7, 0.25, contacts));
  recorder.finish();
  EXPECT_EQ(read_file(dir / "contacts.csv"), kContactColumns +
                                                 "\n7,0.25,10,0.5,0.25,0,-1,-2,-3,0.001,1,2,3,1"
                                                 "\n7,0.25,11,0.5,0.25,0,-4,-5,-6,0.002,4,5,6,0.5\n");
}

TEST(StiffnessRecorder, WritesTheTensorAndItsLargestEigenvalue) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()});
  StepRecord r = test::row(4, 0.002, contacts);
  r.force.S << 1, 2, 3,  //
      2, 5, 6,           //
      3, 6, 9;
  Recorder recorder(dir / "stiffness_tensor.csv", stiffness_rows());
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

constexpr ShapingOperations kShaping = {.start =
                                            [](ContactBuffer& contacts) noexcept {
                                              for (std::size_t i = 0; i < contacts.size(); ++i)
                                                contacts.weight[i] = 1.0;
                                              return stiffness_tensor(contacts);
                                            },
                                        .update =
                                            [](ContactBuffer& contacts, const Mat3& S) noexcept {
                                              for (std::size_t i = 0; i < contacts.size(); ++i) {
                                                contacts.weight[i] /=
                                                    contacts.gradient(i).dot(S * contacts.gradient(i));
                                              }
                                              return stiffness_tensor(contacts);
                                            }};

struct Reference {
  double ratio_min;
  double ratio_max;
  double lambda_max;
};

/// The thesis's way, through the n x n matrix A_ij = <u_i, u_j>^2 and from c = 1 each time (Eq. 3, C.4.2).
Reference evaluate_directly(const std::vector<Vec3>& u, int iterations) {
  const auto n = static_cast<Eigen::Index>(u.size());
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) {
      const double inner = u[static_cast<std::size_t>(i)].dot(u[static_cast<std::size_t>(j)]);
      A(i, j) = inner * inner;
    }
  }
  Eigen::VectorXd c = Eigen::VectorXd::Ones(n);
  for (int m = 0; m < iterations; ++m) c = c.cwiseQuotient(A * c).eval();
  Mat3 S = Mat3::Zero();
  for (Eigen::Index i = 0; i < n; ++i) {
    S += c[i] * u[static_cast<std::size_t>(i)] * u[static_cast<std::size_t>(i)].transpose();
  }
  const Eigen::VectorXd rho = A * c;
  return {rho.minCoeff(), rho.maxCoeff(), Eigen::SelfAdjointEigenSolver<Mat3>(S).eigenvalues()[2]};
}

std::vector<Vec3> random_directions(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3> u(n);
  for (Vec3& direction : u) direction = random.direction();
  return u;
}

TEST(RatioRecorder, EqualsDirectEvaluationForEachRequestedIteration) {
  const TemporaryDirectory dir;
  const std::vector<Vec3> u = random_directions(17, 3);
  const ContactBuffer contacts = test::contacts_along(u);
  const std::vector<int> iterations = {0, 1, 2, 5, 20};
  Recorder recorder(dir / "ratios.csv", ratio_rows(iterations, kShaping, 17));
  recorder.on_step(test::row(3, 0.5, contacts));
  recorder.finish();

  const auto lines = lines_of(read_file(dir / "ratios.csv"));
  ASSERT_EQ(lines.size(), 1 + iterations.size());
  EXPECT_EQ(lines[0], "step,time_s,iteration,rendered,ratio_min,ratio_max,lambda_max");
  for (std::size_t k = 0; k < iterations.size(); ++k) {
    const auto cells = cells_of(lines[k + 1]);
    ASSERT_EQ(cells.size(), 7u);
    EXPECT_EQ(cells[0] + "," + cells[1] + "," + cells[2] + "," + cells[3],
              "3,0.5," + std::to_string(iterations[k]) + ",17");
    const Reference expected = evaluate_directly(u, iterations[k]);
    // Sums of 17 terms, each good to a few ulp (2e-16), at most 20 updates one after the other, which contract towards
    // the fixed point: below 20 * 17 * 3e-16 = 1e-13 relative; the values are between 0.5 and 17.
    const double tolerance = 1e-13 * 17.0;
    EXPECT_NEAR(number_in(cells[4]), expected.ratio_min, tolerance);
    EXPECT_NEAR(number_in(cells[5]), expected.ratio_max, tolerance);
    EXPECT_NEAR(number_in(cells[6]), expected.lambda_max, tolerance);
  }
}

TEST(RatioRecorder, LeavesTheContactsOfTheRunUnchanged) {
  const TemporaryDirectory dir;
  ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitX(), Vec3::UnitY()});
  contacts.weight[0] = 0.125;
  const AlignedDoubles weights = contacts.weight;
  Recorder recorder(dir / "ratios.csv", ratio_rows({5}, kShaping, 3));
  recorder.on_step(test::row(0, 0.0, contacts));
  EXPECT_EQ(contacts.weight, weights);
}

TEST(RatioRecorder, StartsFromEqualWeightsWhateverTheRunUses) {
  const TemporaryDirectory dir;
  ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitX()});
  contacts.weight[0] = contacts.weight[1] = 0.5;
  Recorder recorder(dir / "ratios.csv", ratio_rows({0}, kShaping, 2));
  recorder.on_step(test::row(0, 0.0, contacts));
  recorder.finish();
  EXPECT_EQ(lines_of(read_file(dir / "ratios.csv")).at(1), "0,0,0,2,2,2,2");
}

TEST(EnergyRecorder, WritesTheBalanceOfTheRowsItKeeps) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  EnergyLedger ledger(2.0, 0.5, true, 1);
  Recorder recorder(dir / "energy.csv", energy_rows(ledger), 2);
  for (std::uint64_t k = 0; k < 3; ++k) {
    StepRecord r = test::row(k, 0.5 * static_cast<double>(k), none);
    r.tool.velocity = {static_cast<double>(k), 0, 0};
    r.tool.pose.position.setZero();
    r.force = {};
    r.hand_force = {6, 0, 0};  // pushes with 6 N, of which 4 N get through to 2 kg: 1 m/s more every half second
    r.hand.input = {4, 0, 0};
    r.springs.energy = 0.25;
    r.device.reset();
    ledger.on_step(r);
    recorder.on_step(r);
  }
  recorder.finish();
  EXPECT_EQ(read_file(dir / "energy.csv"), header_of(kEnergyTable.columns) +
                                               "\n0,0,0,0.25,0,0,0,0,0,0,0,0,0,0,,"
                                               "\n2,1,4,0.25,4,0,0,0,0,0,0,0,6,-2,,\n");
}

TEST(EnergyRecorder, FillsTheDeviceColumnsOfADeviceWithMechanics) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  EnergyLedger ledger(2.0, 0.5, true, 1);
  Recorder recorder(dir / "energy.csv", energy_rows(ledger), 1);
  for (std::uint64_t k = 0; k < 2; ++k) {
    StepRecord r = test::row(k, 0.0, none);
    r.device = DeviceEnergy{3.0, 2.0, -1.0, 4.0};
    ledger.on_step(r);
    recorder.on_step(r);
  }
  recorder.finish();
  EXPECT_TRUE(test::lines_of(read_file(dir / "energy.csv"))[2].ends_with(",3,2,-1,4"));
}

StepRecord tilted_row(std::uint64_t step, double tilt, const ContactBuffer& contacts) {
  StepRecord r = test::row(step, 0.0, contacts);
  r.tool.pose = {{0, 0, -0.001}, {-std::sin(tilt), 0, -std::cos(tilt)}};
  return r;
}

TEST(IdealTrajectoryRecorder, KeepsTheRowsThatHaveAnIdealPlace) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  IdealTrajectoryObserver observer({}, {}, 2);
  Recorder recorder(dir / "ideal.csv", ideal_trajectory_rows(observer));
  const double tilts[] = {0.5, 0.6, 1.3, 0.7, 0.8};
  for (std::uint64_t k = 0; k < 5; ++k) {
    const StepRecord r = tilted_row(k, tilts[k], none);
    observer.on_step(r);
    recorder.on_step(r);
  }
  recorder.finish();
  const auto lines = test::lines_of(test::read_file(dir / "ideal.csv"));
  ASSERT_EQ(lines.size(), 3u) << "rows 0 and 4; 1 and 3 lie between, 2 is too steep";
  EXPECT_EQ(lines[0], header_of(kIdealTrajectoryTable.columns));
  EXPECT_TRUE(lines[1].starts_with("0,0,0.5,-0.001,"));
  EXPECT_TRUE(lines[2].starts_with("4,"));
}

TEST(TargetTable, WritesALineForEachTarget) {
  const test::TemporaryDirectory dir;
  TargetRow reached;
  reached.subject = 1;
  reached.trial = 2;
  reached.target = 3;
  reached.result = {1, true, 2.5};
  reached.rows_on_target = 7;
  reached.model_force = 1.5;
  reached.speed = 0.25;
  TargetRow missed;
  missed.result = {0, false, 10.0};
  write_target_table(dir / "targets.csv", {reached, missed});
  EXPECT_EQ(test::read_file(dir / "targets.csv"),
            "subject,trial,target,place,removed,time_s,rows_on_target,model_force_N,speed_m_per_s\n"
            "1,2,3,1,1,2.5,7,1.5,0.25\n"
            "0,0,0,0,0,10,0,,\n");
}

TEST(Recorders, OfContactsWriteNothingForRowsWithoutContactAndRowsBetween) {
  const ContactBuffer none(1);
  const ContactBuffer one = test::contacts_along({Vec3::UnitX()});
  for (const RowSource& source : {contact_rows(), ratio_rows({0}, kShaping, 1)}) {
    const TemporaryDirectory dir;
    Recorder recorder(dir / "table.csv", source, 2);
    recorder.on_step(test::row(0, 0.0, none));
    recorder.on_step(test::row(1, 0.0, one));
    recorder.on_step(test::row(2, 0.0, one));
    recorder.finish();
    const auto lines = lines_of(read_file(dir / "table.csv"));
    ASSERT_EQ(lines.size(), 2u) << lines[0];
    EXPECT_TRUE(lines[1].starts_with("2,")) << lines[1];
  }
}

TEST(Recorders, AllocateNothingInAStep) {
  const ContactBuffer contacts = test::contacts_along(std::vector<Vec3>(100, Vec3::UnitX()));
  StepRecord r = full_row(contacts);
  r.tool.pose = {{0, 0, -0.001}, {-std::sin(0.5), 0, -std::cos(0.5)}};
  r.force.S = Mat3::Identity() / 3.0;
  EnergyLedger ledger(2.0, 0.5, true, contacts.size());
  IdealTrajectoryObserver ideal({}, {});
  const ReferenceForce reference(ReferenceForce::Ideal{});
  ForceFidelityObserver fidelity(reference, 0.5, 1);
  const TemporaryDirectory dir;
  for (const RowSource& source : {trajectory_rows({.pose = true, .torque = true}), contact_rows(), stiffness_rows(),
                                  ratio_rows({0, 1, 5}, kShaping, contacts.size()), energy_rows(ledger),
                                  ideal_trajectory_rows(ideal), force_reference_rows(fidelity)}) {
    Recorder recorder(dir / "table.csv", source);
    const AllocationCount count;
    for (int k = 0; k < 1000; ++k) {  // several times the file's buffer
      r.springs.energy += k;          // an event of the ledger every step
      ledger.on_step(r);
      ideal.on_step(r);
      fidelity.on_step(r);
      recorder.on_step(r);
    }
    EXPECT_EQ(count.value(), 0u) << header_of(source.columns);
    recorder.finish();
    EXPECT_GE(lines_of(read_file(dir / "table.csv")).size(), 1001u) << header_of(source.columns);
  }
}

}  // namespace
}  // namespace hapbench::recorder_test
