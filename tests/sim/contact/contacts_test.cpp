#include <gtest/gtest.h>

#include <limits>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::contacts_test {
namespace {

ContactBuffer random_contacts(std::size_t n) {
  Random random(n);
  ContactBuffer contacts(n);
  for (std::size_t i = 0; i < n; ++i) {
    contacts.push(static_cast<std::uint32_t>(10 * i), random.direction(), random.direction());
    contacts.set_gradient(i, random.direction());
    contacts.depth[i] = random.uniform();
    contacts.weight[i] = random.uniform();
  }
  return contacts;
}

TEST(ContactBuffer, HasRoomForWholePacksUpToItsCapacity) {
  for (std::size_t n = 0; n <= 17; ++n) {
    const ContactBuffer contacts = random_contacts(n);
    EXPECT_EQ(contacts.padded_size() % 8, 0u);
    EXPECT_GE(contacts.padded_size(), n);
    EXPECT_GE(contacts.weight.size(), contacts.padded_size());
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(contacts.weight.data()) % 64, 0u);
  }
}

TEST(ContactBuffer, PadZeroesWhatSumsReadBeyondTheLastContact) {
  ContactBuffer contacts = random_contacts(16);
  contacts.shrink(9);
  contacts.pad();
  for (std::size_t i = 9; i < 16; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
    EXPECT_EQ(contacts.weight[i], 0.0);
  }
  EXPECT_NE(contacts.weight[8], 0.0);
}

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(LambdaMax, IsTheLargestEigenvalue) {
  Random random(4);
  for (std::size_t i = 0; i < test::cases(10000); ++i) {
    const Mat3 Q = test::random_rotation(random);
    Vec3 eigenvalues(random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0));
    if (i % 2 == 0) eigenvalues = {1.0, 1.0, random.uniform()};  // the largest is double
    const Mat3 S = Q * eigenvalues.asDiagonal() * Q.transpose();
    // Building S and the iteration each move eigenvalues by a few roundings of the norm.
    EXPECT_NEAR(lambda_max(S), eigenvalues.maxCoeff(), 32 * kEps * eigenvalues.cwiseAbs().maxCoeff());
  }
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct SpringContact {
  std::uint32_t spring;
  double depth;
  Vec3 gradient;
};

// Gradients whose inner products with dyadic positions are exact.
const SpringSet kBilateral{{{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, true};
const SpringSet kUnilateral{kBilateral.gradients, false}, kUnsigned{kBilateral.gradients, true, false};

TEST(SpringSource, HasTheContactsOfItsKindOfSprings) {
  const struct {
    const char* name;
    SpringSet springs;
    Vec3 position;
    std::vector<SpringContact> contacts;
  } kCases[] = {
      {"bilateral springs always act, with depths of either sign",
       kBilateral,
       {0.25, -0.5, 0.125},
       {{0, 0.25, {1, 0, 0}}, {1, -0.25, {-1, 0, 0}}, {2, 0.5, {0, -1, 0}}, {3, 0.125, {0, 0, 1}}}},
      {"unsigned ones have gradients along the displacement; the fourth is at its natural length",
       kUnsigned,
       {0.25, -0.5, 0.0},
       {{0, 0.25, {1, 0, 0}}, {1, 0.25, {1, 0, 0}}, {2, 0.5, {0, -1, 0}}, {3, 0.0, {0, 0, 1}}}},
      {"unilateral springs act when compressed",
       kUnilateral,
       {0.25, 0.5, 0.125},
       {{0, 0.25, {1, 0, 0}}, {3, 0.125, {0, 0, 1}}}},
      {"and not at their natural length", kUnilateral, {0, 0, 0}, {}},
      {"nor at a position that is not finite", kUnilateral, Vec3::Constant(kNaN), {}},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.name);
    SpringSource source(std::make_shared<const SpringSet>(c.springs));
    EXPECT_EQ(source.capacity(), 4u);
    ContactBuffer contacts(8);
    contacts.depth.assign(16, 1.0);
    source.contacts_at({c.position, -Vec3::UnitZ()}, contacts);
    ASSERT_EQ(contacts.size(), c.contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.index[i], c.contacts[i].spring);
      EXPECT_EQ(contacts.depth[i], c.contacts[i].depth);
      EXPECT_EQ(contacts.gradient(i), c.contacts[i].gradient);
      EXPECT_EQ(contacts.normal(i), Vec3(-c.contacts[i].gradient));
      EXPECT_EQ(contacts.point(i), c.position);
    }
    for (std::size_t i = contacts.size(); i < 8; ++i) EXPECT_EQ(contacts.depth[i], 0.0) << "padded";
    EXPECT_EQ(source.work().queries, 1u);
    EXPECT_EQ(source.work().points_tested, 4u);
    source.reset();
    EXPECT_EQ(source.work().queries, 0u);
  }
}

}  // namespace
}  // namespace hapbench::contacts_test
