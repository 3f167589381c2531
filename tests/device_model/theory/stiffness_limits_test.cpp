#include "device_model/theory/stiffness_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace hapbench::stiffness_limits_test {
namespace {

std::optional<double> limit(const char* name, const SampledLoop& loop) {
  return find_stiffness_limit(name)->largest(loop);
}

SampledLoop damped_loop() {
  SampledLoop loop;
  loop.damping = 1.5;
  loop.wall_damping = 0.5;
  return loop;
}

TEST(StiffnessLimits, SaysWithoutDelayWhatColgateAndSchenkelSay) {
  for (const double B : {-0.5, 0.0, 0.5, 1.4, 1.6}) {
    SampledLoop loop = damped_loop();
    loop.wall_damping = B;
    const double closed = std::max(0.0, 2.0 * (1.5 - std::abs(B)) / 0.001);
    EXPECT_NEAR(*limit("passive_colgate_schenkel", loop), closed, 1e-9);
    EXPECT_NEAR(*limit("passive_with_delay", loop), closed, 1e-6 * closed) << B;
  }
}

TEST(StiffnessLimits, AllowsWithDelayAndWithoutDampingWhatTheClosedFormAllows) {
  SampledLoop loop = damped_loop();
  loop.wall_damping = 0.0;
  for (const double d : {1.0, 2.0, 5.0}) {
    loop.delay = d;
    EXPECT_NEAR(*limit("passive_with_delay", loop), 1.5 / (0.001 * (0.5 + d)), 1e-6 / 0.001) << d;
    EXPECT_FALSE(limit("passive_colgate_schenkel", loop)) << "without delay only";
  }
  loop.delay = 0.5;
  EXPECT_FALSE(limit("passive_with_delay", loop)) << "the sum over the aliases needs whole delays";
}

/// The inequality itself, at every angle of a grid: holds at the limit less a little and fails at a little more.
TEST(StiffnessLimits, ThePassiveStiffnessIsTheLargestThatMeetsTheInequality) {
  const auto holds = [](const SampledLoop& loop, double K) {
    for (int i = 1; i <= 20000; ++i) {
      const double theta = std::numbers::pi * i / 20000, d = loop.delay, a = loop.filter_memory();
      const std::complex<double> e = std::polar(1.0, -theta);
      const std::complex<double> H = K + loop.wall_damping * (1.0 - e) / loop.period * (1.0 - a) / (1.0 - a * e);
      const double need = 0.5 * loop.period / (1.0 - std::cos(theta)) * ((1.0 - e) * std::pow(e, d) * H).real();
      if (loop.damping <= need) return false;
    }
    return true;
  };
  for (const double delay : {0.0, 1.0, 3.0}) {
    for (const std::optional<double> cutoff : {std::optional<double>(), std::optional<double>(60.0)}) {
      SampledLoop loop = damped_loop();
      loop.delay = delay;
      loop.cutoff = cutoff;
      const double K = *limit("passive_with_delay", loop);
      ASSERT_GT(K, 0.0);
      EXPECT_TRUE(holds(loop, K * (1.0 - 1e-6))) << delay;
      EXPECT_FALSE(holds(loop, K * (1.0 + 1e-6))) << delay;
    }
  }
}

TEST(StiffnessLimits, WhatIsPassiveIsStableWithEveryHand) {
  for (const double delay : {0.0, 1.0, 2.0}) {
    for (const double B : {0.0, 0.3, 1.0}) {
      SampledLoop loop = damped_loop();
      loop.delay = delay;
      loop.wall_damping = B;
      // Both edges are numbers to 1e-9; at B = 0 without a hand they come within a thousandth.
      EXPECT_LE(*limit("passive_with_delay", loop), worst_hand_edge(loop) * (1.0 + 1e-9)) << delay << " " << B;
    }
  }
}

TEST(StiffnessLimits, TheLinearConditionComesCloseToTheExactEdgeAtLowDamping) {
  for (const double delay : {0.0, 0.5, 1.0, 2.0, 3.0}) {
    SampledLoop loop;  // m/T = 100 N s/m
    loop.delay = delay;
    loop.damping = 0.5;
    loop.wall_damping = 1.0;
    EXPECT_NEAR(eigenvalue_edge(loop) / *limit("stable_gil_hulin", loop), 1.0, 0.02) << delay;
    const double most = 0.15 * 100.0 / (1.0 + delay);
    loop.wall_damping = 0.999 * most - loop.damping;
    const double ratio = eigenvalue_edge(loop) / *limit("stable_gil_hulin", loop);
    EXPECT_LT(ratio, 1.0) << delay;
    EXPECT_GT(ratio, 0.86) << delay;
    loop.wall_damping = 1.001 * most - loop.damping;
    EXPECT_FALSE(limit("stable_gil_hulin", loop)) << "not low any more";
  }
}

TEST(StiffnessLimits, FrictionMustCoverTheEncodersStep) {
  SampledLoop loop = damped_loop();
  loop.coulomb = 0.02;
  loop.encoder_step = 5e-5;
  EXPECT_FALSE(limit("passive_abbott_okamura", loop)) << "B is not zero";
  loop.wall_damping = 0.0;
  EXPECT_DOUBLE_EQ(*limit("passive_abbott_okamura", loop), 800.0);  // 2 c / q
  loop.coulomb = 1.0;
  EXPECT_DOUBLE_EQ(*limit("passive_abbott_okamura", loop), 3000.0);  // 2 b / T
  loop.encoder_step = 0.0;
  EXPECT_FALSE(limit("passive_abbott_okamura", loop));
}

TEST(StiffnessLimits, TheUndampedHandleHasAClosedForm) {
  SampledLoop loop;
  loop.wall_damping = 50.0;
  EXPECT_NEAR(*limit("exact_undamped_handle", loop), eigenvalue_edge(loop), 1e-9 * eigenvalue_edge(loop));
  loop.hand.mass = 0.2;
  EXPECT_NEAR(*limit("exact_undamped_handle", loop), eigenvalue_edge(loop), 1e-9 * eigenvalue_edge(loop));
  loop.hand.stiffness = 100.0;
  EXPECT_FALSE(limit("exact_undamped_handle", loop));
}

TEST(StiffnessLimits, EveryRowSaysWhereItComesFromAndWhenItApplies) {
  for (const StiffnessLimit& limit : stiffness_limits()) {
    for (const char* text : {limit.name, limit.formula, limit.source, limit.applies}) EXPECT_STRNE(text, "");
    EXPECT_EQ(find_stiffness_limit(limit.name), &limit);
  }
  EXPECT_EQ(find_stiffness_limit("none"), nullptr);
}

}  // namespace
}  // namespace hapbench::stiffness_limits_test
