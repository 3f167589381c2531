#include "device_model/force_sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace hapbench::force_sensor_test {
namespace {

TEST(ForceSensor, ReadsTheWeightOfTheDrillAsWell) {
  ForceSensor sensor({.weight = 0.7, .down = {0, -1, 0}});
  EXPECT_EQ(sensor.read({1, 2, 3}), Vec3(1, 2 - 0.7, 3));
}

TEST(ForceSensor, CompensationTakesTheWeightOffAgainOrLeavesIt) {
  const Vec3 reading{0, 0, -2.7};
  EXPECT_NEAR(ForceSensor({.weight = 0.7}).compensated(reading).z(), -2.0, 1e-15);
  EXPECT_EQ(ForceSensor({.weight = 0.7, .compensated = false}).compensated(reading), reading);
}

TEST(ForceSensor, NoiseHasTheGivenDeviationInEveryComponentAndNoMean) {
  const double sigma = 0.02;
  ForceSensor sensor({.weight = 0.0, .noise = sigma, .seed = 5});
  constexpr int kSamples = 100'000;
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero(), products = Vec3::Zero();
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 e = sensor.read({0, 0, 0}) / sigma;
    sum += e;
    squares += e.cwiseAbs2();
    products += Vec3(e.x() * e.y(), e.y() * e.z(), e.z() * e.x());
  }
  // Five standard errors: 1 / sqrt(n) of the mean and of a product, sqrt(2 / n) of the square.
  const double error = 5.0 / std::sqrt(kSamples);
  EXPECT_LE((sum / kSamples).cwiseAbs().maxCoeff(), error);
  EXPECT_LE((products / kSamples).cwiseAbs().maxCoeff(), error);
  EXPECT_LE((squares / kSamples - Vec3::Ones()).cwiseAbs().maxCoeff(), std::sqrt(2.0) * error);
}

TEST(ForceSensor, TheSeedDecidesTheNoiseAndAResetRepeatsIt) {
  const auto first_reading = [](std::uint64_t seed) {
    return ForceSensor({.noise = 1.0, .seed = seed}).read({0, 0, 0});
  };
  EXPECT_NE(first_reading(1), first_reading(2));
  ForceSensor sensor({.noise = 1.0, .seed = 1});
  const Vec3 first = sensor.read({0, 0, 0});
  EXPECT_NE(sensor.read({0, 0, 0}), first);
  sensor.reset();
  EXPECT_EQ(sensor.read({0, 0, 0}), first);
}

}  // namespace
}  // namespace hapbench::force_sensor_test
