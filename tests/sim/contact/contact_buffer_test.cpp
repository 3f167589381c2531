#include "sim/contact/contact_buffer.hpp"

#include <gtest/gtest.h>

#include "tests/support/bits.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::contact_buffer_test {
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

TEST(ContactBuffer, StartsEmptyWithTheGivenCapacity) {
  const ContactBuffer contacts(13);
  EXPECT_TRUE(contacts.empty());
  EXPECT_EQ(contacts.size(), 0u);
  EXPECT_EQ(contacts.padded_size(), 0u);
  EXPECT_EQ(contacts.capacity(), 13u);
}

TEST(ContactBuffer, PushedContactsHaveNoDepthGradientOrWeight) {
  ContactBuffer contacts = random_contacts(3);
  contacts.clear();
  contacts.push(7, {1, 2, 3}, {0, 1, 0});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_EQ(contacts.index[0], 7u);
  EXPECT_EQ(contacts.point(0), Vec3(1, 2, 3));
  EXPECT_EQ(contacts.normal(0), Vec3(0, 1, 0));
  EXPECT_EQ(contacts.gradient(0), Vec3(0, 0, 0));
  EXPECT_EQ(contacts.depth[0], 0.0);
  EXPECT_EQ(contacts.weight[0], 0.0);
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

TEST(ContactBuffer, PadStaysWithinAFullBuffer) {
  for (std::size_t n = 0; n <= 17; ++n) {
    ContactBuffer contacts = random_contacts(n);
    ASSERT_GE(contacts.weight.size(), n + 8);
    contacts.pad();
  }
}

TEST(ContactBuffer, ShrinkKeepsTheFirstContacts) {
  const ContactBuffer all = random_contacts(12);
  ContactBuffer contacts = all;
  contacts.shrink(5);
  ASSERT_EQ(contacts.size(), 5u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(contacts.index[i], all.index[i]);
}

TEST(ContactBuffer, CopyOverwritesEveryColumn) {
  ContactBuffer contacts = random_contacts(4);
  ContactBuffer expected(4);
  for (const std::size_t from : {0u, 3u, 2u, 3u}) expected.push_copy_of(contacts, from);
  contacts.copy(3, 1);
  EXPECT_EQ(test::hash_of(contacts), test::hash_of(expected));
}

TEST(ContactBuffer, PushCopyOfTakesEveryColumnFromTheOtherBuffer) {
  const ContactBuffer from = random_contacts(6);
  ContactBuffer to(6);
  for (std::size_t i = 0; i < 6; ++i) to.push_copy_of(from, i);
  EXPECT_EQ(test::hash_of(to), test::hash_of(from));
}

TEST(ContactBuffer, AssignTakesAllContactsInPlaceOfItsOwn) {
  const ContactBuffer from = random_contacts(5);
  ContactBuffer to = random_contacts(20);
  to.assign(from);
  EXPECT_EQ(test::hash_of(to), test::hash_of(from));
  for (std::size_t i = 5; i < to.padded_size(); ++i) EXPECT_EQ(to.weight[i], 0.0) << "padded";
}

}  // namespace
}  // namespace hapbench::contact_buffer_test
