#include "algorithms/proxy/proxy_constraints.hpp"

#include <gtest/gtest.h>

#include "sim/contact/stiffness_tensor.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::proxy_constraints_test {
namespace {

/// Sum lambda_i u_i, and what rounding may make of it.
struct Held {
  Vec3 sum = Vec3::Zero();
  double lambdas = 0.0;
};
Held held(const ContactBuffer& contacts) {
  Held h;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    h.sum += contacts.weight[i] * contacts.gradient(i);
    h.lambdas += contacts.weight[i];
  }
  return h;
}

double violation(const ContactBuffer& contacts, std::size_t i, const Vec3& x) {
  return contacts.depth[i] + contacts.gradient(i).dot(x);
}

/// Contacts that a place in the middle satisfies, some of them just so, with a wanted move.
struct Problem {
  ContactBuffer contacts;
  Vec3 wanted;
};
template <class Check>
void for_feasible_problems(Check check) {
  Random random(1);
  for (const test::GradientFamily& family : test::gradient_families()) {
    for (int i = 0; i < 200; ++i) {
      const std::vector<Vec3> gradients = family.draw(random, test::random_size(random, 300));
      const Vec3 allowed = 1e-4 * random.uniform() * random.direction();
      std::vector<double> depths;
      for (const Vec3& u : gradients)
        depths.push_back(-u.dot(allowed) - (random.uniform() < 0.3 ? 0.0 : 1e-4 * random.uniform()));
      check(Problem{test::contacts_of(gradients, depths), 3e-4 * random.uniform() * random.direction()}, family.name);
    }
  }
}

// A convex problem with a strictly convex aim has one solution, and these conditions of Karush, Kuhn and Tucker name
// it.
TEST(NearestAllowed, SatisfiesTheConditionsOfOptimality) {
  for_feasible_problems([](Problem problem, const char* family) {
    const AllowedMove allowed = nearest_allowed(problem.wanted, problem.contacts);
    ASSERT_TRUE(allowed.feasible) << family;
    // Lengths are up to 0.4 mm; an active contact may be off by the rounding of multipliers that cancel.
    const Held h = held(problem.contacts);
    const double rounding = 4e-4 * kViolationTolerance + 1e-13 * h.lambdas;
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      const double off = violation(problem.contacts, i, allowed.move);
      ASSERT_LE(off, rounding) << family;
      ASSERT_GE(problem.contacts.weight[i], 0.0) << family;
      ASSERT_TRUE(problem.contacts.weight[i] == 0.0 || off >= -rounding) << family;
    }
    // Up to three multipliers below the tolerance are left out.
    ASSERT_LE((problem.wanted - h.sum - allowed.move).norm(), 4 * rounding) << family;
  });
}

TEST(NearestAllowed, HoldsTheSpanOfTheActiveContacts) {
  for_feasible_problems([](Problem problem, const char* family) {
    const Mat3 held = nearest_allowed(problem.wanted, problem.contacts).held;
    ASSERT_LE((held * held - held).norm(), 1e-14) << family;
    ASSERT_EQ(held, held.transpose()) << family;
    std::size_t active = 0;
    for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
      if (problem.contacts.weight[i] == 0.0) continue;
      ++active;
      const Vec3 u = problem.contacts.gradient(i);
      ASSERT_LE((held * u - u).norm(), 1e-14) << family;
    }
    ASSERT_LE(active, 3u) << family;
    ASSERT_LE(held.trace(), static_cast<double>(active) + 1e-14) << family;
  });
}

/// n faces against x with depth a, m against -x with depth b, a + b > 0: no room.
TEST(NearestAllowed, SharesWhatOppositeWallsLackInEqualSquares) {
  for (const auto& [n, m] : {std::pair<std::size_t, std::size_t>{1, 1}, {3, 1}, {100, 250}}) {
    const double a = 3e-5, b = 1e-5;
    std::vector<Vec3> gradients(n, Vec3::UnitX());
    gradients.insert(gradients.end(), m, -Vec3::UnitX());
    std::vector<double> depths(n, a);
    depths.insert(depths.end(), m, b);
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const Vec3 wanted(2e-4, -1e-4, 5e-5);
    const AllowedMove allowed = nearest_allowed(wanted, contacts);
    EXPECT_FALSE(allowed.feasible);
    const double N = static_cast<double>(n), M = static_cast<double>(m);
    const double x = (M * b - N * a + kCompromiseEpsilon * wanted.x()) / (N + M + kCompromiseEpsilon);
    // The Newton step solves with a matrix of condition (N + M) / epsilon.
    EXPECT_NEAR(allowed.move.x(), x, 1e-4 * 1e-16 * (N + M) / kCompromiseEpsilon);
    EXPECT_NEAR(allowed.move.y(), wanted.y(), 1e-12);
    EXPECT_NEAR(allowed.move.z(), wanted.z(), 1e-12);
    // Every wall has its violation, and the rest is divided among all N + M of them: the identity holds but for
    // epsilon.
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_NEAR(contacts.weight[i], i < n ? a + x : b - x, 1e-10);
      sum += (contacts.weight[i] + allowed.share.dot(contacts.gradient(i))) * contacts.gradient(i);
    }
    EXPECT_LE((wanted - sum - allowed.move).norm(), 1e-9);
    EXPECT_NEAR(allowed.share.x(), (wanted.x() - x) / (N + M), 1e-9);
    EXPECT_NEAR(allowed.held(0, 0), 1.0, 1e-6);
    EXPECT_NEAR(allowed.held(1, 1), 0.0, 1e-9);
  }
}

TEST(NearestAllowed, FindsTheLeastSquaresOfContradictingContacts) {
  Random random(4);
  int contradicting = 0;
  for (int i = 0; i < 2'000; ++i) {
    const std::size_t n = 4 + random.below(60);
    std::vector<Vec3> gradients;
    std::vector<double> depths;
    for (std::size_t k = 0; k < n; ++k) {
      gradients.push_back(random.direction());
      depths.push_back(1e-4 * random.uniform(-0.5, 1.0));
    }
    ContactBuffer contacts = test::contacts_of(gradients, depths);
    const Vec3 wanted = 2e-4 * random.direction();
    const AllowedMove allowed = nearest_allowed(wanted, contacts);
    if (allowed.feasible) continue;
    ++contradicting;
    // Its gradient vanishes: the solver stops at epsilon times the tolerance, and sums of n terms of 1e-4 are rounded.
    Vec3 gradient = kCompromiseEpsilon * (allowed.move - wanted);
    for (std::size_t k = 0; k < n; ++k) gradient += std::max(0.0, violation(contacts, k, allowed.move)) * gradients[k];
    ASSERT_LE(gradient.norm(), 1e-19 + 1e-20 * static_cast<double>(n * n));
    ASSERT_LE(lambda_max(allowed.held), 1.0);
  }
  EXPECT_GT(contradicting, 1'000);
}

/// The multipliers of a compromise are the derivatives of what it stores, 1/2 |x - t|^2 + 1/2 sum w^2, by the depths,
/// and t - x its derivative by t.
TEST(NearestAllowed, StoresInACompromiseWhatItsMultipliersTakeIn) {
  const std::vector<Vec3> gradients = {Vec3::UnitX(),  Vec3(0.6, 0.8, 0.0),  Vec3(0.6, -0.8, 0.0),
                                       -Vec3::UnitX(), Vec3(-0.8, 0.0, 0.6), Vec3(0.0, 0.6, -0.8)};
  const std::vector<double> depths = {3e-5, 2e-5, 1e-5, 4e-5, 2e-5, 5e-5};
  const Vec3 wanted(2e-4, -1e-4, 5e-5);
  const auto stored = [&](const Vec3& t, const std::vector<double>& d) {
    ContactBuffer contacts = test::contacts_of(gradients, d);
    const AllowedMove allowed = nearest_allowed(t, contacts);
    EXPECT_FALSE(allowed.feasible);
    double energy = 0.5 * (allowed.move - t).squaredNorm();
    for (std::size_t i = 0; i < contacts.size(); ++i) energy += 0.5 * contacts.weight[i] * contacts.weight[i];
    return energy;
  };
  ContactBuffer contacts = test::contacts_of(gradients, depths);
  const AllowedMove here = nearest_allowed(wanted, contacts);
  // Central differences of a function that is quadratic where the same walls are violated; epsilon is 1e-6.
  constexpr double h = 1e-8, kLengths = 3e-4;
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    std::vector<double> more = depths, less = depths;
    more[i] += h;
    less[i] -= h;
    const double lambda = contacts.weight[i] > 0.0 ? contacts.weight[i] + here.share.dot(gradients[i]) : 0.0;
    EXPECT_NEAR((stored(wanted, more) - stored(wanted, less)) / (2.0 * h), lambda, 1e-4 * kLengths) << i;
  }
  for (int k = 0; k < 3; ++k) {
    const Vec3 step = h * Vec3::Unit(k);
    EXPECT_NEAR((stored(wanted + step, depths) - stored(wanted - step, depths)) / (2.0 * h),
                (here.held * (wanted - here.move))[k], 1e-4 * kLengths);
    EXPECT_NEAR((here.held * (wanted - here.move))[k], (wanted - here.move)[k], 1e-4 * kLengths);
  }
}

TEST(NearestAllowed, EndsWithinItsIterationsOnNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, infinite, -infinite}) {
    ContactBuffer contacts = test::contacts_of({Vec3::UnitX(), -Vec3::UnitX(), Vec3(0, bad, 1)}, {1.0, bad, 1.0});
    for (const Vec3& wanted : {Vec3(bad, 0.0, 1.0), Vec3(0.0, 0.0, 1.0)})
      EXPECT_LE(nearest_allowed(wanted, contacts).iterations, 200) << bad;  // 100 exact, 100 of the compromise
  }
}

}  // namespace
}  // namespace hapbench::proxy_constraints_test
