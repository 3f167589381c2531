#include "results/record/ratio_recorder.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "results/allocations/allocations.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::ratio_recorder_test {
namespace {

using test::cells_of;
using test::lines_of;
using test::number_in;
using test::read_file;
using test::TemporaryDirectory;

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
  RatioRecorder recorder(dir / "ratios.csv", 1, iterations, kShaping, 17);
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

TEST(RatioRecorder, SortsTheIterationsAndCountsDuplicatesOnce) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along({Vec3::UnitX()});
  RatioRecorder recorder(dir / "ratios.csv", 1, {10, 1, 10, 0}, kShaping, 1);
  recorder.on_step(test::row(0, 0.0, contacts));
  recorder.finish();
  EXPECT_EQ(read_file(dir / "ratios.csv"),
            "step,time_s,iteration,rendered,ratio_min,ratio_max,lambda_max\n"
            "0,0,0,1,1,1,1\n0,0,1,1,1,1,1\n0,0,10,1,1,1,1\n");
}

TEST(RatioRecorder, LeavesTheContactsOfTheRunUnchanged) {
  const TemporaryDirectory dir;
  ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitX(), Vec3::UnitY()});
  contacts.weight[0] = 0.125;
  const AlignedDoubles weights = contacts.weight;
  RatioRecorder recorder(dir / "ratios.csv", 1, {5}, kShaping, 3);
  recorder.on_step(test::row(0, 0.0, contacts));
  EXPECT_EQ(contacts.weight, weights);
}

TEST(RatioRecorder, StartsFromEqualWeightsWhateverTheRunUses) {
  const TemporaryDirectory dir;
  ContactBuffer contacts = test::contacts_along({Vec3::UnitX(), Vec3::UnitX()});
  contacts.weight[0] = contacts.weight[1] = 0.5;
  RatioRecorder recorder(dir / "ratios.csv", 1, {0}, kShaping, 2);
  recorder.on_step(test::row(0, 0.0, contacts));
  recorder.finish();
  EXPECT_EQ(lines_of(read_file(dir / "ratios.csv")).at(1), "0,0,0,2,2,2,2");
}

TEST(RatioRecorder, WritesNothingForRowsWithoutContactAndRowsBetween) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  const ContactBuffer one = test::contacts_along({Vec3::UnitX()});
  RatioRecorder recorder(dir / "ratios.csv", 2, {0}, kShaping, 1);
  recorder.on_step(test::row(0, 0.0, none));
  recorder.on_step(test::row(1, 0.0, one));
  recorder.on_step(test::row(2, 0.0, one));
  recorder.finish();
  const auto lines = lines_of(read_file(dir / "ratios.csv"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[1].starts_with("2,"));
}

TEST(RatioRecorder, AllocatesNothingInAStep) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along(random_directions(50, 4));
  RatioRecorder recorder(dir / "ratios.csv", 1, {0, 1, 2, 3, 4, 5, 10}, kShaping, 50);
  const StepRecord r = test::row(0, 0.0, contacts);
  const std::size_t before = heap_allocations();
  // Several times the file's buffer.
  for (int k = 0; k < 1000; ++k) recorder.on_step(r);
  EXPECT_EQ(heap_allocations(), before);
}

}  // namespace
}  // namespace hapbench::ratio_recorder_test
