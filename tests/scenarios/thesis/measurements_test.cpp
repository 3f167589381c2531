#include "scenarios/thesis/measurements.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hapbench::measurements_test {
namespace {

/// Returns a set of `size` contacts.
ContactBuffer contacts(std::size_t size) {
  ContactBuffer set(size);
  for (std::size_t i = 0; i < size; ++i) set.push(static_cast<std::uint32_t>(i), Vec3::Zero(), Vec3::UnitZ());
  set.pad();
  return set;
}

/// Uses the processor for at least this time [s].
void work_for(double seconds) {
  const double start = processor_seconds();
  while (processor_seconds() - start < seconds) {
  }
}

/// The work takes as long as the copying, so a time with the copying would be twice the time of the work. The bounds
/// are in the middle between one and two times, and as far below. All sets together are small enough for a processor's
/// cache, in which they stay during the work. Copying one set takes about ten times as long as the calls of the clock,
/// which add to the measured time.
TEST(ComputingTime, OfWorkDoesNotIncludeTheCopyingOfContactSets) {
  const std::vector<ContactBuffer> sets(10, contacts(5000));
  ContactBuffer copy(largest_size(sets));
  std::vector<double> of_copying;
  for (int i = 0; i < kRepetitions; ++i) of_copying.push_back(seconds_of_pass(sets, copy, [](ContactBuffer&) {}));
  const double copying = median(of_copying), work = copying / static_cast<double>(sets.size());
  const double measured = seconds_with(sets, [work](ContactBuffer&) { work_for(work); });
  EXPECT_GT(measured, 0.5 * work);
  EXPECT_LT(measured, 1.5 * work);
}

/// Contact sets that are computed with (here: shrunk) are whole again in the next pass.
TEST(ComputingTime, IsOfTheWholeContactSetInEachRepetition) {
  const std::vector<ContactBuffer> sets(1, contacts(10));
  seconds_with(sets, [](ContactBuffer& set) {
    EXPECT_EQ(set.size(), 10U);
    set.shrink(1);
    work_for(20e-6);
  });
}

TEST(ComputingTime, OfNoContactSetIsNotMeasured) {
  EXPECT_THROW(seconds_with({}, [](ContactBuffer&) { work_for(20e-6); }), NothingToMeasure);
}

}  // namespace
}  // namespace hapbench::measurements_test
