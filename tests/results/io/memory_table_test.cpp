#include "results/io/memory_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "results/allocations/allocations.hpp"
#include "results/record/contact_recorder.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::memory_table_test {
namespace {

constexpr Column kColumns[] = {{"n", "1", ""}, {"x", "m", ""}, {"y", "m", ""},
                               {"z", "m", ""}, {"a", "1", ""}, {"b", "1", ""}};

TEST(MemoryTable, HoldsTheNumbersOfItsCells) {
  MemoryTable table(kColumns);
  EXPECT_EQ(table.rows(), 0u);
  EXPECT_TRUE(table.numbers().empty());
  const double more[] = {5.0};
  table.row(std::uint64_t{1}, Vec3(2.0, 3.0, 4.0), std::span<const double>(more), std::optional<double>());
  ASSERT_EQ(table.rows(), 1u);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(table.numbers()[i], static_cast<double>(i + 1));
  EXPECT_TRUE(std::isnan(table.numbers()[5]));
}

TEST(MemoryTable, KeepsEveryRowWhileItGrows) {
  MemoryTable table(kColumns);
  constexpr std::uint64_t kRows = 100'000;
  for (std::uint64_t k = 0; k < kRows; ++k) table.row(k, Vec3(0.0, 0.0, 0.0), 1.0, 2.0);
  table.require_complete();
  ASSERT_EQ(table.rows(), kRows);
  for (std::uint64_t k = 0; k < kRows; ++k) ASSERT_EQ(table.numbers()[6 * k], static_cast<double>(k));
}

TEST(MemoryTable, IsFilledByARecorderWithoutTheHeap) {
  const ContactBuffer contacts = test::contacts_along(std::vector<Vec3>(100, Vec3::UnitX()));
  MemoryTable table(ContactRecorder::kColumns);
  ContactRecorder recorder(&table);
  const AllocationCount count;
  for (std::uint64_t k = 0; k < 1000; ++k) recorder.on_step(test::row(k, 0.0, contacts));
  EXPECT_EQ(count.value(), 0u);
  recorder.finish();
  EXPECT_EQ(table.rows(), 100'000u);
  EXPECT_EQ(table.numbers().back(), 1.0);
}

}  // namespace
}  // namespace hapbench::memory_table_test
