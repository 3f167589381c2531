#include "algorithms/stages/point_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::gradient_reduction_test {
namespace {

/// A stage prepared for a scene of up to `points` contacts.
std::unique_ptr<PointStage> reduction(const ReductionConfig& config, std::size_t points) {
  auto stage = make_gradient_reduction(config);
  stage->prepare({.capacity = points});
  stage->reset();
  return stage;
}

ContactBuffer reduced(const ReductionConfig& config, ContactBuffer contacts) {
  reduction(config, contacts.size())->process(contacts);
  return contacts;
}

std::vector<std::uint32_t> indices(const ContactBuffer& contacts) {
  return {contacts.index.begin(), contacts.index.begin() + static_cast<std::ptrdiff_t>(contacts.size())};
}

/// Thesis C.3 with its errata (see the source) word by word, on positions in the given visiting order.
struct Reference {
  std::vector<std::size_t> kept;
  std::uint64_t dropped = 0;

  Reference(const ReductionConfig& config, const ContactBuffer& c, const std::vector<std::size_t>& order) {
    for (const std::size_t i : order) {
      const auto similar = std::find_if(kept.begin(), kept.end(), [&](std::size_t k) {
        return c.ux[i] * c.ux[k] + c.uy[i] * c.uy[k] + c.uz[i] * c.uz[k] > config.threshold;
      });
      if (similar != kept.end()) {
        if (c.depth[i] > c.depth[*similar]) *similar = i;
      } else if (kept.size() < config.max_points) {
        kept.push_back(i);
      } else {
        ++dropped;
      }
    }
  }
};

TEST(GradientReduction, IsTheAlgorithmOfTheThesisOnRandomSets) {
  Random random(1);
  for (const auto& family : test::gradient_families()) {
    for (int i = 0; i < 30; ++i) {
      const auto gradients = family.draw(random, 2 + random.below(300));
      const ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, gradients.size()));
      std::vector<std::size_t> ascending(contacts.size());
      for (std::size_t k = 0; k < ascending.size(); ++k) ascending[k] = k;
      const ReductionConfig config{random.uniform(0.5, 1.0), 1 + random.below(40), {}};

      const Reference expected(config, contacts, ascending);
      ContactBuffer actual = contacts;
      const auto stage = reduction(config, contacts.size());
      stage->process(actual);
      ASSERT_EQ(actual.size(), expected.kept.size()) << family.name;
      for (std::size_t k = 0; k < actual.size(); ++k) {
        ASSERT_EQ(actual.index[k], contacts.index[expected.kept[k]]) << family.name;
        ASSERT_EQ(actual.depth[k], contacts.depth[expected.kept[k]]);
        ASSERT_EQ(actual.gradient(k), contacts.gradient(expected.kept[k]));
      }
      ASSERT_EQ(stage->dropped(), expected.dropped) << family.name;
    }
  }
}

TEST(GradientReduction, KeepsTheDeepestOfSimilarContacts) {
  const std::vector<Vec3> same(4, Vec3::UnitX());
  const ContactBuffer contacts = reduced({}, test::contacts_of(same, {2.0, 1.0, 5.0, 3.0}));
  EXPECT_EQ(indices(contacts), std::vector<std::uint32_t>{2});
  EXPECT_EQ(contacts.depth[0], 5.0);
}

TEST(GradientReduction, OfEquallyDeepContactsTheFirstStays) {
  const std::vector<Vec3> same(3, Vec3::UnitX());
  EXPECT_EQ(indices(reduced({}, test::contacts_of(same, {2.0, 2.0, 2.0}))), std::vector<std::uint32_t>{0});
}

TEST(GradientReduction, InnerProductsEqualToTheThresholdAreNotSimilar) {
  // <u_0, u_1> = 0.5 exactly.
  const std::vector<Vec3> gradients = {{1, 0, 0}, {0.5, std::sqrt(0.75), 0}};
  EXPECT_EQ(reduced({0.5, 100, {}}, test::contacts_of(gradients)).size(), 2u);
  EXPECT_EQ(reduced({std::nextafter(0.5, 0.0), 100, {}}, test::contacts_of(gradients)).size(), 1u);
}

TEST(GradientReduction, TheFirstSimilarKeptContactAbsorbsEvenIfALaterOneIsMoreSimilar) {
  // The third lies between the first two and is similar to both, nearer to the second.
  const auto at = [](double degrees) {
    return Vec3(std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180), 0);
  };
  const ContactBuffer contacts = reduced({std::cos(10 * std::numbers::pi / 180), 100, {}},
                                         test::contacts_of({at(0), at(12), at(8)}, {1.0, 1.0, 7.0}));
  EXPECT_EQ(indices(contacts), (std::vector<std::uint32_t>{2, 1}));
}

TEST(GradientReduction, AReplacementIsComparedWithFromThenOn) {
  // The first is replaced by the second, 8 degrees on; the third is similar to the second only.
  const auto at = [](double degrees) {
    return Vec3(std::cos(degrees * std::numbers::pi / 180), std::sin(degrees * std::numbers::pi / 180), 0);
  };
  const ContactBuffer contacts = reduced({std::cos(10 * std::numbers::pi / 180), 100, {}},
                                         test::contacts_of({at(0), at(8), at(16)}, {1.0, 2.0, 1.5}));
  EXPECT_EQ(indices(contacts), std::vector<std::uint32_t>{1});
}

TEST(GradientReduction, ContactsBeyondMaxPointsAreDroppedAndCountedUntilReset) {
  const ContactBuffer contacts =
      test::contacts_of({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {1, 0, 0}}, {1, 1, 1, 1, 3});
  const auto stage = reduction({0.995, 2, {}}, 5);
  for (int step = 1; step <= 3; ++step) {
    ContactBuffer actual = contacts;
    stage->process(actual);
    // The last contact is absorbed by the first although the buffer is full.
    EXPECT_EQ(indices(actual), (std::vector<std::uint32_t>{4, 1}));
    EXPECT_EQ(stage->dropped(), 2u * static_cast<unsigned>(step));
  }
  stage->reset();
  EXPECT_EQ(stage->dropped(), 0u);
}

TEST(GradientReduction, LeavesASingleContactAndNoneAlone) {
  ContactBuffer one = test::contacts_of({Vec3::UnitX()}, {2.0});
  const std::uint64_t before = test::hash_of(one);
  const auto stage = reduction({}, 1);
  stage->process(one);
  EXPECT_EQ(test::hash_of(one), before);
  ContactBuffer none = test::contacts_of({});
  stage->process(none);
  EXPECT_TRUE(none.empty());
}

TEST(GradientReduction, PadsTheKeptContacts) {
  const ContactBuffer contacts = reduced({}, test::contacts_of(std::vector<Vec3>(8, Vec3::UnitX())));
  ASSERT_EQ(contacts.size(), 1u);
  for (std::size_t i = 1; i < 8; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
  }
}

// ---- The optional random visiting order.

/// Gradients no two of which are similar, so that the reduction keeps all of them in its visiting order.
ContactBuffer dissimilar(std::size_t n) {
  std::vector<Vec3> gradients;
  for (std::size_t i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    gradients.push_back({std::cos(a), std::sin(a), 0});
  }
  return test::contacts_of(gradients);
}

std::vector<std::uint32_t> visiting_order(std::uint64_t seed, std::size_t n) {
  const ReductionConfig config{0.9999999, n, seed};
  return indices(reduced(config, dissimilar(n)));
}

TEST(GradientReduction, AShuffleVisitsEveryPointInAnOrderFixedByItsSeed) {
  const auto order = visiting_order(7, 100);
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), 100u);
  EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
  EXPECT_EQ(order, visiting_order(7, 100));
  EXPECT_NE(order, visiting_order(8, 100));
}

TEST(GradientReduction, AShuffledOrderIsOneOfTheShellsPointsNotOfTheStepsContacts) {
  // Whatever else collides, two points are visited in the same order.
  const auto order = visiting_order(7, 100);
  const ContactBuffer all = dissimilar(100);
  const auto stage = reduction({0.9999999, 100, 7}, 100);
  Random random(2);
  for (int step = 0; step < 50; ++step) {
    ContactBuffer some(100);
    for (std::size_t i = 0; i < 100; ++i) {
      if (random.uniform() < 0.3) some.push_copy_of(all, i);
    }
    some.pad();
    std::vector<std::uint32_t> expected;
    for (const std::uint32_t i : order) {
      const auto present = indices(some);
      if (std::find(present.begin(), present.end(), i) != present.end()) expected.push_back(i);
    }
    stage->process(some);
    ASSERT_EQ(indices(some), expected);
  }
}

TEST(GradientReduction, AShuffledReductionIsTheAlgorithmInTheShuffledOrder) {
  Random random(3);
  const auto order = visiting_order(11, 200);
  for (int i = 0; i < 30; ++i) {
    std::vector<Vec3> gradients(200);
    for (Vec3& u : gradients) u = random.direction();
    const ContactBuffer contacts = test::contacts_of(gradients, test::random_depths(random, 200));
    const ReductionConfig config{0.9, 30, 11};
    const Reference expected(config, contacts, {order.begin(), order.end()});
    const ContactBuffer actual = reduced(config, contacts);
    ASSERT_EQ(actual.size(), expected.kept.size());
    for (std::size_t k = 0; k < actual.size(); ++k) {
      ASSERT_EQ(actual.index[k], expected.kept[k]);
      ASSERT_EQ(actual.depth[k], contacts.depth[expected.kept[k]]);
    }
  }
}

}  // namespace
}  // namespace hapbench::gradient_reduction_test
