#include "sim/contact/contact_source.hpp"

#include <gtest/gtest.h>

namespace hapbench::spring_source_test {
namespace {

// Gradients whose inner products with dyadic positions are exact.
const std::vector<Vec3> kGradients = {{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}};

std::shared_ptr<const SpringSet> springs(bool bilateral) {
  return std::make_shared<const SpringSet>(SpringSet{kGradients, bilateral});
}

ContactBuffer contacts_at(const Vec3& position, bool bilateral) {
  SpringSource source(springs(bilateral));
  ContactBuffer contacts(source.capacity());
  source.contacts_at({position, -Vec3::UnitZ()}, contacts);
  return contacts;
}

TEST(SpringSource, BilateralSpringsAlwaysActWithDepthsOfEitherSign) {
  const Vec3 p(0.25, -0.5, 0.125);
  const ContactBuffer contacts = contacts_at(p, true);
  ASSERT_EQ(contacts.size(), 4u);
  const std::vector<double> depths = {0.25, -0.25, 0.5, 0.125};
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_EQ(contacts.index[j], j);
    EXPECT_EQ(contacts.depth[j], depths[j]);
    EXPECT_EQ(contacts.gradient(j), kGradients[j]);
    EXPECT_EQ(contacts.normal(j), Vec3(-kGradients[j]));
    EXPECT_EQ(contacts.point(j), p);
  }
}

TEST(SpringSource, UnilateralSpringsActOnlyWhenCompressed) {
  const ContactBuffer contacts = contacts_at({0.25, 0.5, 0.125}, false);
  ASSERT_EQ(contacts.size(), 2u);
  EXPECT_EQ(contacts.index[0], 0u);
  EXPECT_EQ(contacts.index[1], 3u);
  EXPECT_EQ(contacts.depth[0], 0.25);
  EXPECT_EQ(contacts.depth[1], 0.125);
}

TEST(SpringSource, UnsignedSpringsHaveDepthsOfEitherSideAndGradientsAlongTheDisplacement) {
  const Vec3 p(0.25, -0.5, 0.0);
  SpringSource source(std::make_shared<const SpringSet>(SpringSet{kGradients, true, false}));
  ContactBuffer contacts(source.capacity());
  source.contacts_at({p, -Vec3::UnitZ()}, contacts);
  ASSERT_EQ(contacts.size(), 4u);
  const std::vector<double> depths = {0.25, 0.25, 0.5, 0.0};
  // The second spring's <p, u> is negative; the fourth is at its natural length and keeps its gradient.
  const std::vector<Vec3> gradients = {{1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 0, 1}};
  const ContactBuffer signed_contacts = contacts_at(p, true);
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_EQ(contacts.depth[j], depths[j]);
    EXPECT_EQ(contacts.gradient(j), gradients[j]);
    EXPECT_EQ(contacts.normal(j), Vec3(-gradients[j]));
    EXPECT_EQ(contacts.depth[j] * contacts.gradient(j), signed_contacts.depth[j] * signed_contacts.gradient(j))
        << "the same force";
  }
}

TEST(SpringSource, AUnilateralSpringAtItsNaturalLengthDoesNotAct) {
  EXPECT_TRUE(contacts_at(Vec3::Zero(), false).empty());
  EXPECT_EQ(contacts_at(Vec3::Zero(), true).size(), 4u);
}

TEST(SpringSource, ANonFinitePositionCompressesNoUnilateralSpring) {
  EXPECT_TRUE(contacts_at(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), false).empty());
}

TEST(SpringSource, GivesDepthsItselfAndPadsThem) {
  SpringSource source(springs(true));
  EXPECT_EQ(source.capacity(), 4u);
  ContactBuffer contacts(8);
  contacts.depth.assign(8, 1.0);
  source.contacts_at({}, contacts);
  for (std::size_t i = 4; i < 8; ++i) EXPECT_EQ(contacts.depth[i], 0.0);
}

TEST(SpringSource, CountsQueriesAndSpringsTested) {
  SpringSource source(springs(true));
  ContactBuffer contacts(source.capacity());
  for (int i = 0; i < 3; ++i) source.contacts_at({}, contacts);
  EXPECT_EQ(source.work().queries, 3u);
  EXPECT_EQ(source.work().points_tested, 12u);
  source.reset();
  EXPECT_EQ(source.work().queries, 0u);
}

}  // namespace
}  // namespace hapbench::spring_source_test
