#include "algorithms/registry.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "algorithms/laws/exact_shaping.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::merged_shaping_test {
namespace {

constexpr double kK = 20'000.0;
constexpr double kEps = 2.3e-16;

LawForce evaluate(ContactBuffer& contacts) {
  RenderingConfig config;
  config.stiffness = kK;
  const auto law = make_law("merged_shaping", config);
  law->prepare(contacts.capacity());
  return law->evaluate(contacts);
}

template <class Check>
void for_random_contacts(Check check) {
  Random random(1);
  for (const test::GradientFamily& family : test::gradient_families()) {
    for (int i = 0; i < 200; ++i) {
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

// Of the projection onto a cone of tensors of trace 1, whatever their rank: tr S >= |S|^2, and the eigenvalues'
// extreme.
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
}  // namespace hapbench::merged_shaping_test
