#include "algorithms/stages/point_stage.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "sim/contact/contact_query.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/fakes.hpp"

namespace hapbench::local_average_test {
namespace {

constexpr double kCell = 0.001;

/// A contact as a test writes it down.
struct Contact {
  double x;  ///< position along the x axis, in cells
  double depth;
  Vec3 gradient;
};

/// The contacts of a shell of these points after the stage.
class LocalAverage : public testing::Test {
 protected:
  ContactBuffer averaged(const std::vector<Contact>& all, const std::vector<std::uint32_t>& colliding) {
    prepare(all);
    return process(all, colliding);
  }

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

// One rounding each in a product, a sum, a division, a norm.
constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();

TEST_F(LocalAverage, MergesContactsOfACellIntoTheMeanOfTheirDepthVectors) {
  const std::vector<Contact> all = {{0.0, 3.0, {1, 0, 0}}, {0.2, 4.0, {0, 1, 0}}};
  const ContactBuffer contacts = averaged(all, {0, 1});
  ASSERT_EQ(contacts.size(), 1u);
  // Mean of (3, 0, 0) and (0, 4, 0): length 5/2, direction (3, 4)/5.
  EXPECT_NEAR(contacts.depth[0], 2.5, kRounding * 2.5);
  EXPECT_LE((contacts.gradient(0) - Vec3(0.6, 0.8, 0)).norm(), kRounding);
}

TEST_F(LocalAverage, KeepsContactsOfDifferentCellsApart) {
  const std::vector<Contact> all = {{0.0, 3.0, {1, 0, 0}}, {1.0, 4.0, {0, 1, 0}}};
  const ContactBuffer contacts = averaged(all, {0, 1});
  ASSERT_EQ(contacts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(contacts.index[i], i);
    EXPECT_EQ(contacts.depth[i], all[i].depth);
    EXPECT_EQ(contacts.gradient(i), all[i].gradient);
  }
}

TEST_F(LocalAverage, CountsOnlyCollidingPointsOfACell) {
  const std::vector<Contact> all = {{0.0, 2.0, {1, 0, 0}}, {0.1, 9.0, {1, 0, 0}}, {0.2, 4.0, {1, 0, 0}}};
  const ContactBuffer contacts = averaged(all, {0, 2});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts.depth[0], 3.0);
}

TEST_F(LocalAverage, KeepsIndexPointAndNormalOfTheCellsFirstContact) {
  const std::vector<Contact> all = {{1.0, 1.0, {0, 0, 1}}, {0.1, 2.0, {1, 0, 0}}, {0.2, 4.0, {0, 1, 0}}};
  const ContactBuffer contacts = averaged(all, {0, 1, 2});
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts.index[1], 1u);
  EXPECT_EQ(contacts.point(1), Vec3(0.1 * kCell, 0, 0));
  EXPECT_EQ(contacts.normal(1), Vec3(-1, 0, 0));
}

TEST_F(LocalAverage, DropsACellWhoseDepthVectorsCancel) {
  const std::vector<Contact> all = {
      {0.0, 2.0, {1, 0, 0}}, {0.1, 2.0, {-1, 0, 0}}, {1.0, 5.0, {0, 0, 1}}, {2.0, 0.0, {0, 1, 0}}};
  const ContactBuffer contacts = averaged(all, {0, 1, 2, 3});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts.index[0], 2u);
}

TEST_F(LocalAverage, MayLeaveNoContact) {
  EXPECT_TRUE(averaged({{0.0, 2.0, {1, 0, 0}}, {0.1, 2.0, {-1, 0, 0}}}, {0, 1}).empty());
  EXPECT_TRUE(averaged({{0.0, 2.0, {1, 0, 0}}}, {}).empty());
}

TEST_F(LocalAverage, PadsTheMergedContacts) {
  const std::vector<Contact> all(8, {0.0, 3.0, {1, 0, 0}});
  const ContactBuffer contacts = averaged(all, {0, 1, 2, 3, 4, 5, 6, 7});
  ASSERT_EQ(contacts.size(), 1u);
  for (std::size_t i = 1; i < 8; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
  }
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
  // Several steps on one stage: nothing of a step may be left for the next.
  for (int step = 0; step < 20; ++step) {
    std::vector<std::uint32_t> colliding;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (random.uniform() < 0.5) colliding.push_back(i);
    }
    const ContactBuffer contacts = process(all, colliding);

    std::map<std::uint32_t, std::pair<Vec3, double>> sums;
    std::vector<std::uint32_t> order;
    for (const std::uint32_t i : colliding) {
      if (!sums.contains(cell[i])) order.push_back(cell[i]);
      auto& [sum, count] = sums.try_emplace(cell[i], Vec3::Zero(), 0.0).first->second;
      sum += all[i].depth * all[i].gradient;
      count += 1.0;
    }
    ASSERT_EQ(contacts.size(), sums.size());
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      EXPECT_EQ(cell[contacts.index[k]], order[k]) << "cells keep the order of their first contact";
      const auto& [sum, count] = sums.at(order[k]);
      EXPECT_LE((contacts.depth[k] * contacts.gradient(k) - sum / count).norm(), 4 * kRounding);
      EXPECT_NEAR(contacts.gradient(k).norm(), 1.0, kRounding);
    }
  }
}

TEST_F(LocalAverage, MergesTheCellsThatAShellWasListedBy) {
  // Two cells that share their vertices, so that positions alone cannot tell whose a point is.
  const Vec3 a(0, 0, 0), b(0, kCell, 0);
  shell_ = std::make_unique<PointShell>(std::vector<SurfacePoint>{{a}, {b}, {a}, {b}}, kCell,
                                        std::vector<std::uint32_t>{0, 0, 1, 1});
  stage_ = make_local_average();
  stage_->prepare({.shell = shell_.get()});
  const std::vector<Contact> all = {{0, 3.0, {1, 0, 0}}, {0, 4.0, {0, 1, 0}}, {0, 3.0, {1, 0, 0}}, {0, 4.0, {0, 1, 0}}};
  const ContactBuffer both = process(all, {0, 1, 2, 3});
  ASSERT_EQ(both.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(both.index[i], 2 * i);
    EXPECT_NEAR(both.depth[i], 2.5, kRounding * 2.5);
    EXPECT_LE((both.gradient(i) - Vec3(0.6, 0.8, 0)).norm(), kRounding);
  }
  const ContactBuffer one_each = process(all, {1, 2});
  ASSERT_EQ(one_each.size(), 2u);
  EXPECT_EQ(one_each.depth[0], 4.0);
  EXPECT_EQ(one_each.depth[1], 3.0);
}

TEST_F(LocalAverage, RefusesScenesWithoutAGrid) {
  const auto stage = make_local_average();
  EXPECT_THROW(stage->prepare({}), std::invalid_argument);
  const PointShell without_grid({}, 0.0);
  EXPECT_THROW(stage->prepare({.shell = &without_grid}), std::invalid_argument);
}

}  // namespace
}  // namespace hapbench::local_average_test
