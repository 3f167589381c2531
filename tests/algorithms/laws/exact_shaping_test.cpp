#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/dense_laws.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::exact_shaping_test {
namespace {

constexpr double kShapingEps = kExactShapingEpsilon;

// Closed forms of small symmetric sets: the solver leaves a residual of 1e-14 in S.
constexpr double kRounding = 2e-14;

Mat3 solve(ContactBuffer& contacts) {
  solve_exact_shaping(contacts);
  return stiffness_tensor(contacts);
}

/// n gradients in a ring around z, each with z-component `height`.
std::vector<Vec3> ring(int n, double height) {
  std::vector<Vec3> gradients;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n, r = std::sqrt(1 - height * height);
    gradients.push_back({r * std::cos(a), r * std::sin(a), height});
  }
  return gradients;
}

TEST(ExactShaping, OneContactKeepsItsSpring) {
  ContactBuffer contacts = test::contacts_of({Vec3(0.6, 0.64, 0.48)});
  solve_exact_shaping(contacts);
  EXPECT_NEAR(contacts.weight[0], 1 / (1 + kShapingEps), kRounding);
}

TEST(ExactShaping, ParallelAndOppositeContactsShareOneSpringEqually) {
  for (const std::size_t n : {2u, 7u, 8u, 9u, 1000u}) {
    std::vector<Vec3> gradients(n, Vec3::UnitY());
    for (std::size_t i = 0; i < n; i += 3) gradients[i] = -Vec3::UnitY();
    ContactBuffer contacts = test::contacts_of(gradients);
    solve_exact_shaping(contacts);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(contacts.weight[i], 1 / (static_cast<double>(n) + kShapingEps), kRounding);
    }
  }
}

TEST(ExactShaping, OrthogonalContactsKeepTheirSprings) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, -1, 0}, {0, 0, 1}});
  EXPECT_LE((solve(contacts) - Mat3::Identity() / (1 + kShapingEps)).norm(), kRounding);
}

TEST(ExactShaping, AWedgeIsShapedToItsClosedForm) {
  // Two faces with <u_1, u_2>^2 = q: c (1 + q + eps) = 1.
  for (const double degrees : {1.0, 30.0, 60.0, 89.0, 135.0, 179.0}) {
    const double a = degrees * std::numbers::pi / 180, q = std::cos(a) * std::cos(a);
    ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {std::cos(a), std::sin(a), 0}});
    solve_exact_shaping(contacts);
    EXPECT_NEAR(contacts.weight[0], 1 / (1 + q + kShapingEps), 1e-9) << degrees;
    EXPECT_NEAR(contacts.weight[1], contacts.weight[0], 1e-9) << degrees;
    EXPECT_NEAR(contacts.weight[0] + contacts.weight[1], 2 / (1 + q + kShapingEps), 4 * kRounding) << degrees;
  }
}

TEST(ExactShaping, AContactThatMakesAnotherRedundantTakesItsWeight) {
  // The middle one of three within 45 degrees already has ratio above 1 by the outer two: weight zero.
  const double r = std::sqrt(0.5);
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {std::cos(0.7), std::sin(0.7), 0}, {r, r, 0}});
  solve_exact_shaping(contacts);
  EXPECT_EQ(contacts.weight[1], 0.0);
  EXPECT_NEAR(contacts.weight[0], 1 / (1.5 + kShapingEps), 1e-9);
}

TEST(ExactShaping, ARingIsShapedToItsClosedForm) {
  // By symmetry equal weights t / n with t (s^4 / 2 + z^4 + eps / n) = 1, s^2 = 1 - z^2: S = diag(t s^2/2, t s^2/2, t
  // z^2).
  for (const double height : {0.0, 0.2, 0.5, 0.9, 0.999}) {
    for (const int n : {3, 8, 101}) {
      ContactBuffer contacts = test::contacts_of(ring(n, height));
      const double z2 = height * height, s2 = 1 - z2;
      const double t = 1 / (s2 * s2 / 2 + z2 * z2 + kShapingEps / n);
      const Mat3 expected = Vec3(t * s2 / 2, t * s2 / 2, t * z2).asDiagonal();
      EXPECT_LE((solve(contacts) - expected).norm(), 2 * kRounding) << "z = " << height << ", n = " << n;
    }
  }
}

TEST(ExactShaping, TheBoundOnLambdaMaxIsAttained) {
  // The ring with z^2 = 1/sqrt 3 in 3-D, the wedge with cos^2 = 1/sqrt 2 in the plane: no smaller bound holds.
  ContactBuffer space = test::contacts_of(ring(12, std::pow(3.0, -0.25)));
  EXPECT_NEAR(lambda_max(solve(space)), (1 + std::sqrt(3.0)) / 2, 2 * kShapingEps);
  const double x = std::pow(2.0, -0.25), y = std::sqrt(1 - x * x);
  ContactBuffer plane = test::contacts_of({{x, y, 0}, {x, -y, 0}});
  EXPECT_NEAR(lambda_max(solve(plane)), (1 + std::sqrt(2.0)) / 2, 2 * kShapingEps);
}

TEST(ExactShaping, AZeroGradientGetsNoWeight) {
  ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {0, 0, 0}, {0, 1, 0}});
  solve_exact_shaping(contacts);
  EXPECT_EQ(contacts.weight[1], 0.0);
  EXPECT_NEAR(contacts.weight[0], 1 / (1 + kShapingEps), kRounding);
}

TEST(ExactShaping, ANonFiniteGradientDoesNotHang) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    ContactBuffer contacts = test::contacts_of({{1, 0, 0}, {bad, 0, 0}, {0, 1, 0}});
    // The answer is useless, and the next check of bounds ends the run, but the time must be bounded.
    EXPECT_LE(solve_exact_shaping(contacts), 1000);
  }
}

TEST(ExactShaping, ForceIsThatOfItsWeightsAndNewtonStepsAreCounted) {
  Random random(1);
  RenderingConfig config;
  const auto law = make_law("exact_shaping", config);
  std::uint64_t steps = 0;
  for (int i = 0; i < 20; ++i) {
    std::vector<Vec3> gradients(50);
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, 50)), same = contacts;
    const LawForce force = law->evaluate(contacts);
    steps += static_cast<std::uint64_t>(solve_exact_shaping(same));
    EXPECT_EQ(test::weights(contacts), test::weights(same));
    const test::Dense dense(contacts);
    const Eigen::VectorXd c = test::weights(contacts);
    const double rounding = 100 * std::numeric_limits<double>::epsilon();
    EXPECT_LE((force.spring - dense.spring(config.stiffness, c)).norm(),
              rounding * config.stiffness * dense.magnitude(c));
    EXPECT_LE((force.S - dense.S(c)).norm(), rounding * c.sum());
  }
  EXPECT_EQ(law->iterations(), steps);
  law->reset();
  EXPECT_EQ(law->iterations(), 0u);
}

TEST(ExactShaping, DoesNotRememberEarlierWeights) {
  Random random(2);
  std::vector<Vec3> gradients(50);
  for (Vec3& u : gradients) u = random.direction();
  ContactBuffer contacts = test::contacts_of(gradients);
  solve_exact_shaping(contacts);
  const Eigen::VectorXd first = test::weights(contacts);
  for (double& c : contacts.weight) c = 1e6;
  contacts.pad();
  solve_exact_shaping(contacts);
  EXPECT_EQ(test::weights(contacts), first);
}

/// The defining problem as nonnegative least squares: minimise |[U; sqrt(eps) I] c - [I; 0]|, U's columns the nine
/// entries of u u^T.
Eigen::VectorXd weights_by_least_squares(const test::Dense& contacts) {
  const Eigen::Index n = contacts.n();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(9 + n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Mat3 tensor = contacts.U.col(i) * contacts.U.col(i).transpose();
    A.col(i).head<9>() = tensor.reshaped();
    A(9 + i, i) = std::sqrt(kShapingEps);
  }
  Eigen::VectorXd b = Eigen::VectorXd::Zero(9 + n);
  b.head<9>() = Mat3::Identity().reshaped();
  return test::nonnegative_least_squares(A, b);
}

TEST(ExactShaping, EqualsAnIndependentNonnegativeLeastSquaresSolution) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(100); ++i) {
      ContactBuffer contacts = test::contacts_of(family.draw(random, test::random_size(random, 40)));
      const test::Dense dense(contacts);
      const Eigen::VectorXd reference = weights_by_least_squares(dense);

      // The reference is certified on its own before it is believed.
      ContactBuffer certified = contacts;
      for (std::size_t k = 0; k < contacts.size(); ++k) certified.weight[k] = reference[static_cast<Eigen::Index>(k)];
      ASSERT_GE(reference.minCoeff(), 0.0);
      ASSERT_LE(test::shaping_optimality(certified, kShapingEps).violation, test::kShapingRounding) << family.name;

      solve_exact_shaping(contacts);
      const double violation = 2 * test::kShapingRounding;
      ASSERT_LE((stiffness_tensor(contacts) - dense.S(reference)).norm(),
                test::tensor_tolerance(contacts.size(), violation, kShapingEps))
          << family.name << ", set " << i;
      ASSERT_LE((test::weights(contacts) - reference).norm(),
                test::weight_tolerance(contacts.size(), violation, kShapingEps))
          << family.name << ", set " << i;
    }
  }
}

/// f(c) = c^T A c / 2 - 1^T c = |S|^2 / 2 - tr S, what the iteration minimises.
double objective(const Mat3& S) {
  return 0.5 * S.squaredNorm() - S.trace();
}

TEST(ExactShaping, IsWhatTheShapingIterationTendsTo) {
  // The update minimises the auxiliary function of Sha et al. (2007); with it and log rho <= rho - 1 one finds for any
  // weights c* that  f(c_m) - f(c*) <= (D(c*) + 2 (f(c_0) - f(c_m))) / m,  D(c*) = sum c* log c* - c* + 1: the
  // iteration approaches the optimum at least like 1/m. And by the optimality of c* for eps,
  // |S_m - S*|^2 / 2 <= f(c_m) - f(c*) + eps <c*, c_m>.
  Random random(2);
  for (const auto& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(10); ++i) {
      ContactBuffer contacts = test::contacts_of(family.draw(random, test::random_size(random, 50)));
      solve_exact_shaping(contacts);
      const Mat3 exact = stiffness_tensor(contacts);
      const Eigen::VectorXd c = test::weights(contacts);
      double divergence = 0.0;
      for (const double ci : c) divergence += (ci > 0.0 ? ci * std::log(ci) : 0.0) - ci + 1.0;

      Mat3 S = shape_weights(contacts, 0);
      const double start = objective(S);
      int m = 0;
      for (const int iterations : {1, 10, 100, 1000, 10000}) {
        for (; m < iterations; ++m) S = update_shaped_weights(contacts, S);
        // Rounding of the objective, numbers of at most n^2.
        const double rounding = 1e-12 * (1.0 + std::abs(start));
        const double bound = (divergence + 2 * (start - objective(S))) / m + rounding;
        ASSERT_LE(objective(S) - objective(exact), bound) << family.name << ", m = " << m;
        ASSERT_LE(0.5 * (S - exact).squaredNorm(), bound + kShapingEps * c.dot(test::weights(contacts)))
            << family.name << ", m = " << m;
      }
    }
  }
}

TEST(ExactShaping, IsCloseToManyIterationsOnGenericSets) {
  // The bound above is worst case; sets without near-degeneracy come much closer: three digits after 10000 iterations.
  Random random(3);
  for (std::size_t i = 0; i < test::cases(30); ++i) {
    std::vector<Vec3> gradients(3 + random.below(30));
    for (Vec3& u : gradients) u = random.direction();
    ContactBuffer exact = test::contacts_of(gradients), iterated = exact;
    solve_exact_shaping(exact);
    const Mat3 S = stiffness_tensor(exact);
    const double after_3 = (shape_weights(iterated, 3) - S).norm();
    const double after_10000 = (shape_weights(iterated, 10000) - S).norm();
    EXPECT_LE(after_10000, 1e-3);
    EXPECT_LE(after_10000, after_3);
  }
}

constexpr double kK = 20'000.0;
constexpr double kEps = 2.3e-16;

/// The second answer of a law, which is to remember nothing of the first.
LawForce evaluate(ContactBuffer& contacts) {
  RenderingConfig config;
  config.stiffness = kK;
  const auto law = make_law("merged_shaping", config);
  law->prepare(contacts.capacity());
  ContactBuffer before = contacts;
  law->evaluate(before);
  return law->evaluate(contacts);
}

template <class Check>
void for_random_contacts(Check check) {
  Random random(1);
  for (const test::GradientFamily& family : test::gradient_families()) {
    for (std::size_t i = 0; i < test::cases(200); ++i) {
      const std::vector<Vec3> gradients = family.draw(random, test::random_size(random, 300));
      check(gradients, test::random_depths(random, gradients.size()), family.name);
    }
  }
}

TEST(MergedShaping, KeepsTheTensorsAndDepthVectorsOfAllContacts) {
  for_random_contacts([](const auto& gradients, const auto& depths, const char* family) {
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const LawForce force = evaluate(contacts);
    ASSERT_EQ(contacts.size(), gradients.size()) << family;  // none is dropped
    Mat3 S = Mat3::Zero();
    Vec3 g = Vec3::Zero();
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      ASSERT_GE(contacts.weight[i], 0.0) << family;
      S += contacts.weight[i] * gradients[i] * gradients[i].transpose();
      g += contacts.weight[i] * depths[i] * gradients[i];
    }
    const double rounding = 4 * kEps * static_cast<double>(gradients.size() + 8);
    ASSERT_LE((force.S - S).norm(), rounding * (1 + S.norm())) << family;
    ASSERT_LE((force.spring + kK * g).norm(), rounding * kK * 0.001 * 3) << family;  // sum c <= 3
  });
}

TEST(MergedShaping, SharesOneWeightAmongContactsOfTheSameDirection) {
  for_random_contacts([](const auto& gradients, const auto& depths, const char* family) {
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    evaluate(contacts);
    for (std::size_t i = 1; i < gradients.size(); ++i) {
      if (gradients[i] == gradients[0]) {
        ASSERT_EQ(contacts.weight[i], contacts.weight[0]) << family;
      }
    }
  });
}

/// The bound of exact_shaping, whose proof needs tensors of trace 1 only: tr S >= |S|^2.
TEST(MergedShaping, IsNeverStifferThanTheProvenBound) {
  for_random_contacts([](const auto& gradients, const auto& depths, const char* family) {
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const Mat3 S = evaluate(contacts).S;
    const double rounding = 1e-12;  // of the optimality, 1e-14 a tensor
    ASSERT_GE(S.trace() + rounding, S.squaredNorm()) << family;
    ASSERT_LE(lambda_max(S), (1 + std::sqrt(3.0)) / 2 + rounding) << family;
  });
}

TEST(MergedShaping, RegulatesTheMeanRatioOfEveryGroupWithWeight) {
  for_random_contacts([](const auto& gradients, const auto& depths, const char* family) {
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const Mat3 S = evaluate(contacts).S;
    // Contacts of one weight > 0 are of one group, or of groups that happen to have the same; either way their mean is
    // 1 but for epsilon C <= 3e-6.
    for (std::size_t i = 0; i < gradients.size(); ++i) {
      if (!(contacts.weight[i] > 0.0)) continue;
      double ratios = 0.0, members = 0.0;
      for (std::size_t j = 0; j < gradients.size(); ++j) {
        if (contacts.weight[j] != contacts.weight[i]) continue;
        ratios += gradients[j].dot(S * gradients[j]);
        members += 1.0;
      }
      ASSERT_NEAR(ratios / members, 1.0, 3.1e-6) << family;
    }
  });
}

TEST(MergedShaping, DoesNotDependOnTheOrderOfTheContacts) {
  Random random(2);
  for_random_contacts([&](const auto& gradients, const auto& depths, const char* family) {
    std::vector<std::size_t> order(gradients.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    order = test::shuffled(order, random);
    std::vector<Vec3> other_gradients;
    std::vector<double> other_depths;
    for (const std::size_t i : order) {
      other_gradients.push_back(gradients[i]);
      other_depths.push_back(depths[i]);
    }
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    ContactBuffer other = test::contacts_of(other_gradients, other_depths);
    const LawForce a = evaluate(contacts), b = evaluate(other);
    // Sums in another order; the solver knows single weights to rounding over epsilon.
    ASSERT_LE((a.S - b.S).norm(), 1e-9) << family;
    ASSERT_LE((a.spring - b.spring).norm(), 1e-9 * kK * 0.001 * static_cast<double>(gradients.size())) << family;
  });
}

TEST(MergedShaping, TurnsWithTheSceneByTheTurnsOfTheCube) {
  // Away from borders of cells, which a turn may give to the other side.
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    std::vector<Vec3> gradients;
    for (std::size_t k = 0; k < 30; ++k) gradients.push_back(random.direction());
    const std::vector<double> depths = test::random_depths(random, gradients.size());
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const LawForce force = evaluate(contacts);
    Mat3 turn;
    turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    Mat3 mirror_turn;
    mirror_turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    for (const Mat3& R : {turn, mirror_turn, Mat3(turn * mirror_turn)}) {
      std::vector<Vec3> turned;
      for (const Vec3& u : gradients) turned.emplace_back(R * u);
      ContactBuffer there = test::contacts_of(turned, depths);
      ASSERT_LE((evaluate(there).spring - R * force.spring).norm(), 1e-9 * kK * 0.03);
    }
  }
}

TEST(MergedShaping, IsExactShapingWithOneContactAGroup) {
  ContactBuffer merged = test::contacts_of({Vec3::UnitX(), -Vec3::UnitX(), Vec3(0, 0.6, 0.8), Vec3::UnitY()});
  ContactBuffer exact = merged;
  const LawForce force = evaluate(merged);
  solve_exact_shaping(exact);
  EXPECT_LE((force.S - stiffness_tensor(exact)).norm(), 1e-12);
  for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(merged.weight[i], exact.weight[i], 1e-9);
}

}  // namespace
}  // namespace hapbench::exact_shaping_test
