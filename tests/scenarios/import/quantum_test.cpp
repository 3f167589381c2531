#include "scenarios/import/quantum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/core/random.hpp"

namespace hapbench::quantum_test {
namespace {

std::vector<double> values(std::size_t count, double quantum, double offset) {
  Random random(1);
  std::vector<double> all;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = offset + 0.1 * random.uniform();
    all.push_back(quantum > 0.0 ? quantum * std::round(x / quantum) : x);
  }
  return all;
}

TEST(Quantum, OfRoundedNumbersIsTheirStep) {
  for (const double quantum : {1e-3, 1e-5, 5.5e-5, 1e-6, 1e-8}) {
    for (const double offset : {0.0, -0.03, 7.0}) {
      const auto found = quantum_of(values(1000, quantum, offset));
      if (quantum < 2e-9 * std::abs(offset)) {
        EXPECT_FALSE(found) << "rounding hides it";
        continue;
      }
      ASSERT_TRUE(found) << quantum;
      EXPECT_NEAR(*found / quantum, 1.0, 1e-5) << offset;
    }
  }
}

TEST(Quantum, IsFoundWhereNoNeighboursAreAStepApart) {
  const auto found = quantum_of(std::vector<double>{0.0, 6e-5, 15e-5, 25e-5});
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 1e-5, 1e-15);
}

TEST(Quantum, OfNumbersKeptInFullIsNone) {
  EXPECT_FALSE(quantum_of(values(1000, 0.0, 0.0)));
  EXPECT_FALSE(quantum_of(std::vector<double>{0.25, 0.25}));
  EXPECT_FALSE(quantum_of({}));
}

}  // namespace
}  // namespace hapbench::quantum_test
