#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scenarios/input/nearest_name.hpp"

namespace hapbench::nearest_name_test {
namespace {

const std::vector<std::string> kNames = {"stiffness_N_per_m", "damping_ratio", "mass_kg", "mu_s_N_s_per_m", "mean"};

TEST(NearestName, ForgivesOneSlipOfTheFingers) {
  for (const char* slip : {"stiffnes_N_per_m", "stiffness_N_per_mm", "stiffness_n_per_m", "stifness_N_per_m"}) {
    EXPECT_EQ(nearest_name(slip, kNames), "stiffness_N_per_m") << slip;
  }
  EXPECT_EQ(nearest_name("maen", kNames), "mean") << "neighbours swapped";
  EXPECT_EQ(nearest_name("moon", kNames), "") << "two letters of four: could mean anything";
  EXPECT_EQ(nearest_name("mesn", kNames), "mean");
}

TEST(NearestName, KnowsANameByItsBeginningOrAPart) {
  EXPECT_EQ(nearest_name("stiffness", kNames), "stiffness_N_per_m");
  EXPECT_EQ(nearest_name("STIFFNESS", kNames), "stiffness_N_per_m") << "upper and lower case are equal";
  EXPECT_EQ(nearest_name("ratio", kNames), "damping_ratio");
}

TEST(NearestName, SuggestsNothingForSomethingElse) {
  EXPECT_EQ(nearest_name("colour", kNames), "");
  EXPECT_EQ(nearest_name("", kNames), "");
  EXPECT_EQ(nearest_name("x", kNames), "");
  EXPECT_EQ(nearest_name("mean", {}), "");
  EXPECT_EQ(nearest_name(std::string(1'000'000, 'm'), kNames), "");
}

}  // namespace
}  // namespace hapbench::nearest_name_test
