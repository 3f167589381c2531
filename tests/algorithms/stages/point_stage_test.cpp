#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "algorithms/penalty_rendering.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::point_stage_test {
namespace {

/// Returns a stage prepared for a scene of up to `points` contacts.
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

/// The algorithm of section C.3 of the thesis, with the corrections that the `source` text in point_stage.cpp
/// describes. `order`: order in which the contacts are visited.
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
  for (const auto& family : test::gradient_distributions()) {
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
      for (std::size_t k = actual.size(); k < actual.padded_size(); ++k) ASSERT_EQ(actual.depth[k], 0.0);
    }
  }
}

TEST(GradientReduction, OfEquallyDeepContactsTheFirstStays) {
  const std::vector<Vec3> same(3, Vec3::UnitX());
  EXPECT_EQ(indices(reduced({}, test::contacts_of(same, {2.0, 2.0, 2.0}))), std::vector<std::uint32_t>{0});
}

TEST(GradientReduction, InnerProductsEqualToTheThresholdAreNotSimilar) {
  // The inner product <u_0, u_1> is exactly 0.5.
  const std::vector<Vec3> gradients = {{1, 0, 0}, {0.5, std::sqrt(0.75), 0}};
  EXPECT_EQ(reduced({0.5, 100, {}}, test::contacts_of(gradients)).size(), 2u);
  EXPECT_EQ(reduced({std::nextafter(0.5, 0.0), 100, {}}, test::contacts_of(gradients)).size(), 1u);
}

/// Returns gradients of which no two are similar, so that the reduction keeps all of them in its visiting order.
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

TEST(GradientReduction, AShuffledReductionVisitsTheShellsPointsInAnOrderOfItsSeed) {
  Random random(3);
  constexpr std::size_t n = 200;
  const auto order = visiting_order(11, n);
  EXPECT_NE(order, visiting_order(12, n));
  for (int i = 0; i < 30; ++i) {
    // Only some of the n points collide. The order in which they are visited must not depend on the other points.
    ContactBuffer contacts(n);
    std::vector<std::optional<std::size_t>> index(n);
    for (std::uint32_t k = 0; k < n; ++k) {
      if (random.uniform() < 0.3) continue;
      index[k] = contacts.size();
      contacts.push(k, Vec3::Zero(), Vec3::UnitZ());
      contacts.set_gradient(*index[k], random.direction());
      contacts.depth[*index[k]] = random.uniform();
    }
    contacts.pad();
    std::vector<std::size_t> visited;
    for (const std::uint32_t k : order) {
      if (index[k]) visited.push_back(*index[k]);
    }
    const ReductionConfig config{0.9, 30, 11};
    const Reference expected(config, contacts, visited);
    ContactBuffer actual = contacts;
    reduction(config, n)->process(actual);
    ASSERT_EQ(actual.size(), expected.kept.size());
    for (std::size_t k = 0; k < actual.size(); ++k) {
      ASSERT_EQ(actual.index[k], contacts.index[expected.kept[k]]);
      ASSERT_EQ(actual.depth[k], contacts.depth[expected.kept[k]]);
    }
  }
}

constexpr double kCell = 0.001;

/// Input of one contact of a test.
struct Contact {
  double x;  ///< position along the x axis, in cells
  double depth;
  Vec3 gradient;
};

/// Fixture that applies the local average to contacts of a shell with given points.
class LocalAverage : public testing::Test {
 protected:
  void prepare(const std::vector<Contact>& all) {
    std::vector<SurfacePoint> points;
    for (const Contact& c : all) points.push_back({{c.x * kCell, 0, 0}, -c.gradient});
    shell_ = std::make_unique<PointShell>(points, kCell);
    stage_ = make_local_average();
    stage_->prepare({.shell = shell_.get()});
  }

  ContactBuffer process(const std::vector<Contact>& all, const std::vector<std::uint32_t>& colliding) {
    ContactBuffer contacts(all.size());
    for (const std::uint32_t i : colliding) {
      const std::size_t k = contacts.size();
      contacts.push(i, shell_->point(i).position, shell_->point(i).normal);
      contacts.depth[k] = all[i].depth;
      contacts.set_gradient(k, all[i].gradient);
    }
    contacts.pad();
    stage_->process(contacts);
    return contacts;
  }

  std::unique_ptr<PointShell> shell_;
  std::unique_ptr<PointStage> stage_;
};

// Relative rounding error of a product, a sum, a division and a norm.
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

TEST_F(LocalAverage, DropsACellWhoseDepthVectorsCancel) {
  const std::vector<Contact> all = {
      {0.0, 2.0, {1, 0, 0}}, {0.1, 2.0, {-1, 0, 0}}, {1.0, 5.0, {0, 0, 1}}, {2.0, 0.0, {0, 1, 0}}};
  prepare(all);
  const ContactBuffer contacts = process(all, {0, 1, 2, 3});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts.index[0], 2u);
}

TEST_F(LocalAverage, EqualsAStraightforwardMeanOnRandomContactsStepAfterStep) {
  Random random(1);
  constexpr std::uint32_t n = 200;
  std::vector<Contact> all;
  for (std::uint32_t i = 0; i < n; ++i) {
    all.push_back({random.uniform(0.0, 30.0), random.uniform(0.1, 1.0), random.direction()});
  }
  prepare(all);
  const std::vector<std::uint32_t> cell = shell_->cell_of_points();
  // Take several steps with one stage, which must not keep any state between steps.
  for (int step = 0; step < 20; ++step) {
    std::vector<std::uint32_t> colliding;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (random.uniform() < 0.5) colliding.push_back(i);
    }
    const ContactBuffer contacts = process(all, colliding);

    std::map<std::uint32_t, std::pair<Vec3, double>> sums;
    std::vector<std::uint32_t> order;
    for (const std::uint32_t i : colliding) {
      if (!sums.contains(cell[i])) order.push_back(i);
      auto& [sum, count] = sums.try_emplace(cell[i], Vec3::Zero(), 0.0).first->second;
      sum += all[i].depth * all[i].gradient;
      count += 1.0;
    }
    ASSERT_EQ(contacts.size(), sums.size());
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      EXPECT_EQ(contacts.index[k], order[k]) << "that of the cell's first contact, in this order";
      EXPECT_EQ(contacts.point(k), shell_->point(order[k]).position);
      EXPECT_EQ(contacts.normal(k), shell_->point(order[k]).normal);
      const auto& [sum, count] = sums.at(cell[order[k]]);
      EXPECT_LE((contacts.depth[k] * contacts.gradient(k) - sum / count).norm(), 4 * kRounding);
      EXPECT_NEAR(contacts.gradient(k).norm(), 1.0, kRounding);
    }
    for (std::size_t k = contacts.size(); k < contacts.padded_size(); ++k) EXPECT_EQ(contacts.depth[k], 0.0);
  }
}

}  // namespace
}  // namespace hapbench::point_stage_test
