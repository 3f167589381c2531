#include "results/observe/force_fidelity.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "results/allocations/allocations.hpp"
#include "sim/core/random.hpp"

namespace hapbench::force_fidelity_test {
namespace {

constexpr double kDt = 0.001;

StepRecord row(std::uint64_t step, const Vec3& rendered, const Vec3& spring) {
  StepRecord record;
  record.step = step;
  record.time = kDt * static_cast<double>(step);
  record.force.rendered = rendered;
  record.force.spring = spring;
  return record;
}

ReferenceForce constant(const Vec3& force, double last = 10.0) {
  return ReferenceForce({{0.0, force}, {last, force}});
}

TEST(ForceFidelity, SplitsTheErrorAlongWhatIsRendered) {
  const ReferenceForce measured = constant({0.3, 0, 2});
  ForceFidelityObserver observer(measured, kDt, 1);
  observer.on_step(row(0, {0, 0, 1.6}, {0, 0, 1}));
  EXPECT_NEAR(told(observer, "force_error_normal_rms_N").value(), 0.4, 1e-15);
  EXPECT_NEAR(told(observer, "force_error_tangential_rms_N").value(), 0.3, 1e-15);
  EXPECT_NEAR(told(observer, "force_error_rms_N").value(), 0.5, 1e-15);
  EXPECT_NEAR(told(observer, "force_direction_error_rad").value(), std::atan2(0.3, 2.0), 1e-15);
}

TEST(ForceFidelity, CountsWhatLiesAcrossAnIdealForceAsArtefact) {
  // x rises from 0 as 2 t; the rendered force has as much along y.
  const ReferenceForce ideal(ReferenceForce::Ideal{Profile(Profile::Ramp{0.0, 2.0}), Profile(0.0), Profile(0.0)});
  EXPECT_EQ(*ideal.at(0.25), Vec3(0.5, 0, 0));
  ForceFidelityObserver observer(ideal, kDt, 10);
  for (std::uint64_t k = 0; k < 10; ++k) {
    const double f = 2.0 * kDt * static_cast<double>(k);
    observer.on_step(row(k, {f, f, 0}, {f, f, 0}));
  }
  EXPECT_NEAR(told(observer, "force_artefact_share").value(), std::sqrt(0.5), 1e-15);
}

TEST(ForceFidelity, WhereNothingIsRenderedTheNormalIsTheMeasuredForces) {
  const ReferenceForce measured = constant({0.3, 0, 2});
  ForceFidelityObserver observer(measured, kDt, 1);
  observer.on_step(row(0, Vec3::Zero(), Vec3::Zero()));
  EXPECT_NEAR(told(observer, "force_error_normal_rms_N").value(), told(observer, "reference_force_rms_N").value(),
              1e-15);
  EXPECT_NEAR(told(observer, "force_error_tangential_rms_N").value(), 0.0, 1e-15);
  EXPECT_EQ(told(observer, "direction_rows"), 0.0);
}

TEST(ForceFidelity, PartsAddUpAndTurnWithTheWorld) {
  Random random(1);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, random.direction()).toRotationMatrix();
  std::vector<ReferenceForce::Sample> samples, turned;
  for (int i = 0; i < 50; ++i) {
    samples.push_back({0.002 * i, random.uniform() * random.direction()});
    turned.push_back({0.002 * i, turn * samples.back().force});
  }
  const ReferenceForce measured(samples), measured_turned(turned);
  ForceFidelityObserver one(measured, kDt, 90), other(measured_turned, kDt, 90);
  for (std::uint64_t k = 0; k < 90; ++k) {
    const Vec3 spring = k % 3 == 0 ? Vec3::Zero() : Vec3(random.direction()),
               rendered = spring + 0.15 * random.direction();
    one.on_step(row(k, rendered, spring));
    other.on_step(row(k, turn * rendered, turn * spring));
  }
  EXPECT_NEAR(
      std::hypot(told(one, "force_error_normal_rms_N").value(), told(one, "force_error_tangential_rms_N").value()),
      told(one, "force_error_rms_N").value(), 1e-14);
  for (const char* name : {"force_error_rms_N", "force_error_normal_rms_N", "force_error_tangential_rms_N",
                           "force_direction_error_rad", "reference_force_rms_N"})
    EXPECT_NEAR(told(one, name).value(), told(other, name).value(), 1e-13) << name;
}

TEST(ForceFidelity, LeavesOutRowsThatWereNotMeasured) {
  const ReferenceForce measured({{0.002, {0, 0, 1}}, {0.004, {0, 0, 3}}});
  ForceFidelityObserver observer(measured, kDt, 10);
  for (std::uint64_t k = 0; k < 10; ++k) {
    observer.on_step(row(k, Vec3::Zero(), Vec3::Zero()));
    EXPECT_EQ(observer.reference().has_value(), k >= 2 && k <= 4) << k;
  }
  EXPECT_EQ(told(observer, "rows"), 3.0);
  EXPECT_NEAR(told(observer, "reference_force_rms_N").value(), std::sqrt((1.0 + 4.0 + 9.0) / 3.0), 1e-15);
}

/// A force that wanders like a hand's, with what is below 5 Hz alone.
Vec3 wandering(double t) {
  const double w = 2.0 * std::numbers::pi;
  return {std::sin(1.3 * w * t), std::sin(2.9 * w * t + 1.0), 2.0 + std::cos(4.7 * w * t)};
}

TEST(ForceFidelity, FindsTheLag) {
  for (const double lag : {0.0, 0.0123, -0.031, 0.08}) {
    std::vector<Vec3> early, late;
    for (int k = 0; k < 3000; ++k) {
      early.push_back(wandering(kDt * k));
      late.push_back(0.5 * wandering(kDt * k - lag) + Vec3(0, 0, 1));
    }
    const auto found = lag_between(early, late, kDt, kMostLag);
    ASSERT_TRUE(found);
    // The parabola is off by its third-order term, far below a sample.
    EXPECT_NEAR(found->time, lag, 0.05 * kDt);
    EXPECT_NEAR(lag_between(late, early, kDt, kMostLag)->time, -lag, 0.05 * kDt);
  }
}

TEST(ForceFidelity, TakesTheLagNearestToZeroOfPeriodicForces) {
  for (const double frequency : {8.0, 10.0, 12.0, 15.0, 20.0, 50.0}) {
    for (const double part : {0.0, 0.3, -0.2}) {  // of a period
      std::vector<Vec3> early, late;
      for (int k = 0; k < 3000; ++k) {
        const double phase = 2.0 * std::numbers::pi * frequency * kDt * k;
        early.push_back({0, 0, 1.0 + std::sin(phase)});
        late.push_back({0, 0, 1.0 + std::sin(phase - 2.0 * std::numbers::pi * part)});
      }
      const auto found = lag_between(early, late, kDt, kMostLag);
      ASSERT_TRUE(found) << frequency;
      EXPECT_NEAR(found->time, part / frequency, 0.05 * kDt) << frequency << " Hz, " << part;
      // A second answer is within reach for periods up to the range on the other side of 0, and at its end (10 Hz, 0).
      const double other = (1.0 - std::abs(part)) / frequency;
      ASSERT_EQ(found->period.has_value(), other < kMostLag + 0.5 * kDt) << frequency << " Hz, " << part;
      EXPECT_NEAR(found->period.value_or(1.0 / frequency), 1.0 / frequency, 0.6 * kDt);
    }
  }
}

TEST(ForceFidelity, FindsNoLagBeyondItsReach) {
  std::vector<Vec3> early, late;
  for (int k = 0; k < 3000; ++k) {
    early.push_back({0, 0, kDt * k});
    late.push_back({0, 0, std::max(0.0, kDt * (k - 500))});
  }
  EXPECT_FALSE(lag_between(early, std::vector<Vec3>(3000, Vec3(0, 0, 1)), kDt, kMostLag));
  EXPECT_FALSE(lag_between({}, {}, kDt, kMostLag));
  EXPECT_FALSE(lag_between(early, late, kDt, kMostLag)) << "0.5 s late";
}

TEST(ForceFidelity, AllocatesNothingInARow) {
  const ReferenceForce measured = constant({0, 0, 1});
  ForceFidelityObserver observer(measured, kDt, 1000);
  const std::uint64_t before = heap_allocations();
  for (std::uint64_t k = 0; k < 1000; ++k) observer.on_step(row(k, {0, 0, 1}, {0, 0, 1}));
  EXPECT_EQ(heap_allocations(), before);
}

}  // namespace
}  // namespace hapbench::force_fidelity_test
