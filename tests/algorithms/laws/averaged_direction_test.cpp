#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::averaged_direction_test {
namespace {

/// One spring along the averaged gradient, whose depth d_r is a function of the depths and of |sum u_i|.
struct Law {
  const char* name;
  double (*depth)(const Eigen::VectorXd& depths, double length);
};
const Law kLaws[] = {{"original_averaging", [](const Eigen::VectorXd& d, double length) { return d.sum() / length; }},
                     {"highest_depth", [](const Eigen::VectorXd& d, double) { return d.maxCoeff(); }}};

/// With K = 1.
LawForce evaluate(const char* law, const std::vector<Vec3>& gradients, const std::vector<double>& depths = {}) {
  ContactBuffer contacts = test::contacts_of(gradients, depths);
  RenderingConfig config;
  config.stiffness = 1.0;
  return make_law(law, config)->evaluate(contacts);
}

TEST(AveragedDirection, IsOneSpringAlongTheSummedGradient) {
  RenderingConfig config;
  config.stiffness = 1234.5;
  for (const Law& law : kLaws) {
    test::for_random_contacts([&](ContactBuffer contacts, const char* family) {
      const test::Dense dense(contacts);
      const Vec3 sum = dense.U.rowwise().sum();
      const double n = static_cast<double>(dense.n()), length = sum.norm();
      // If gradients cancel down to rounding, there is no direction.
      if (length < 1e-6 * n) return;
      const Vec3 u = sum / length;
      const double d = law.depth(dense.d, length);

      const LawForce force = make_law(law.name, config)->evaluate(contacts);
      // The sum has an error of n eps per component, its direction and inverse length that divided by its length.
      const double rounding = 4 * n * n * std::numeric_limits<double>::epsilon() / length;
      ASSERT_LE((force.spring + 1234.5 * d * u).norm(), rounding * 1234.5 * d) << law.name << ' ' << family;
      ASSERT_LE((force.S - u * u.transpose()).norm(), rounding) << law.name << ' ' << family;
    });
  }
}

TEST(AveragedDirection, TurnsRoundWhereOneOfOpposedContactsComes) {
  // Thesis B.3.3: of m contacts one way and one more or fewer the other way, the original algorithm adds all depths.
  for (const Law& law : kLaws) {
    for (const int n : {0, 1, 5, 50}) {
      for (const int more : {-1, 0, 1}) {
        const int m = n + 1, all = 2 * m + more;
        std::vector<Vec3> gradients(static_cast<std::size_t>(m), Vec3::UnitX());
        gradients.resize(static_cast<std::size_t>(all), -Vec3::UnitX());
        const LawForce force = evaluate(law.name, gradients, std::vector<double>(gradients.size(), 1.0));
        EXPECT_EQ(force.spring, Vec3(more * law.depth(Eigen::VectorXd::Ones(all), 1.0), 0, 0)) << law.name << ' ' << n;
        EXPECT_EQ(force.S, more == 0 ? Mat3(Mat3::Zero()) : Mat3(Vec3::UnitX().asDiagonal())) << law.name << ' ' << n;
      }
    }
  }
}

TEST(AveragedDirection, CountsGradientsAsCancelledUpToABillionthOfTheirNumber) {
  // Two opposite gradients and one of length t: |sum| = t against 3e-9.
  const auto with_rest = [](double t) {
    return evaluate("original_averaging", {Vec3::UnitX(), -Vec3::UnitX(), t * Vec3::UnitY()}).spring.norm();
  };
  EXPECT_EQ(with_rest(2.9e-9), 0.0);
  EXPECT_GT(with_rest(3.1e-9), 0.0);
}

TEST(HighestDepth, OfStretchedSpringsIsTheLeastStretched) {
  // Depths of bilateral springs may all be negative; the padding's zeros are no depths.
  EXPECT_EQ(evaluate("highest_depth", {Vec3::UnitX(), Vec3::UnitX()}, {-0.5, -0.25}).spring, Vec3(0.25, 0, 0));
}

TEST(HighestDepth, StoresTheEnergyOfItsOneSpring) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 1, 0}}, {0.001, 0.003});
  RenderingConfig config;
  const auto law = make_law("highest_depth", config);
  const LawForce force = law->evaluate(contacts);
  EXPECT_DOUBLE_EQ(law->spring_state(contacts, force.spring, Vec3::Zero()).energy,
                   0.5 * config.stiffness * 0.003 * 0.003);
}

}  // namespace
}  // namespace hapbench::averaged_direction_test
