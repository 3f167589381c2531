#include <gtest/gtest.h>

#include "tests/scenarios/thesis_claims/claim_rules.hpp"

/// The rules of the appendices' claims A, B, D and F, with numbers made up to pass and numbers made up to fail.
namespace hapbench::claim_rules_appendices_test {
namespace {

using test::expect_verdict;

MeasuredCase vibrating(double variation, double power) {
  return {"", {{"velocity_variation", {variation}}, {"vibration_power", {power}}, {"force_reversals", {6}}}};
}

TEST(ClaimRules, A1AndB4Vibration) {
  const MeasuredCase smooth = vibrating(0.1, 1e-5), more = vibrating(0.4, 1e-3), much_more = vibrating(0.5, 2.5e-4);
  expect_verdict("A1", Measured{much_more, smooth, smooth, smooth}, Verdict::reproduced);
  // Much more power, not as much more variation.
  expect_verdict("A1", Measured{more, smooth, much_more, smooth}, Verdict::in_kind);
  expect_verdict("A1", Measured{smooth, smooth, much_more, smooth}, Verdict::not_reproduced);
  expect_verdict("B4", Measured{smooth, smooth, much_more, smooth}, Verdict::reproduced);
  expect_verdict("B4", Measured{more, smooth, more, smooth}, Verdict::in_kind);
  expect_verdict("B4", Measured{more, smooth, smooth, smooth}, Verdict::not_reproduced);
}

TEST(ClaimRules, A2SpringsUnlimited) {
  const auto arrives = [](double pairs, double tandpasta) -> MeasuredCase {
    return {"",
            {{"pairs", {pairs}},
             {"original_averaging", {1}},
             {"summation", {1}},
             {"mean", {1}},
             {"virtual_coupling", {1}},
             {"shaped_stiffness", {1}},
             {"tandpasta", {tandpasta}}}};
  };
  expect_verdict("A2", Measured{arrives(100, 0), arrives(100, 1)}, Verdict::reproduced);
  expect_verdict("A2", Measured{arrives(100, 0), arrives(4, 1)}, Verdict::in_kind);
  expect_verdict("A2", Measured{arrives(100, 0), arrives(4, 0)}, Verdict::not_reproduced);
}

TEST(ClaimRules, A3SpringsLimited) {
  const auto run = [](const char* name, double overshoot, double swings, double arrives = 1.0) -> MeasuredCase {
    return {name,
            {{"overshoot_unlimited", {1e-4}},
             {"overshoot", {overshoot}},
             {"swings_unlimited", {2}},
             {"swings", {swings}},
             {"arrives", {arrives}}}};
  };
  const MeasuredCase keeps = run("shaped_stiffness", 1.09e-4, 2), fluctuates = run("other", 1e-3, 7);
  expect_verdict("A3", Measured{keeps, fluctuates}, Verdict::reproduced);
  expect_verdict("A3", Measured{keeps, run("other", 1e-3, 6)}, Verdict::in_kind);
  expect_verdict("A3", Measured{run("shaped_stiffness", 1.11e-4, 2), fluctuates}, Verdict::in_kind);
  expect_verdict("A3", Measured{run("shaped_stiffness", 1e-4, 2, 0.0), fluctuates}, Verdict::in_kind);
  expect_verdict("A3", Measured{run("shaped_stiffness", 1e-4, 3), run("other", 1e-3, 6)}, Verdict::not_reproduced);
}

TEST(ClaimRules, A4StabilityLimits) {
  const auto limits = [](double stiffness, double damping) {
    return Measured{{"K_max (B = 0)", {{"limit", {stiffness}}}}, {"B_max (K = 0)", {{"limit", {damping}}}}};
  };
  expect_verdict("A4", limits(1.01 * 1.6e6, 399), Verdict::reproduced);
  expect_verdict("A4", limits(1.1 * 1.6e6, 399), Verdict::in_kind);
  expect_verdict("A4", limits(1.6e6, 520), Verdict::not_reproduced);
}

TEST(ClaimRules, B1FlippedGradient) {
  expect_verdict("B1", {{"with_shortest_distance", -1}, {"with_surface_normal", 1}}, Verdict::reproduced);
  expect_verdict("B1", {{"with_shortest_distance", -1}, {"with_surface_normal", -1}}, Verdict::in_kind);
  expect_verdict("B1", {{"with_shortest_distance", 1}, {"with_surface_normal", 1}}, Verdict::not_reproduced);
}

TEST(ClaimRules, B2Groove) {
  const auto damped = [](double original) {
    return MeasuredCase{"", {{"original_averaging", {original}}, {"shaped_stiffness", {0.6}}}};
  };
  expect_verdict("B2", Measured{damped(0.3), damped(0.1), damped(0.0)}, Verdict::reproduced);
  expect_verdict("B2", Measured{damped(0.3), damped(0.1), damped(0.31)}, Verdict::in_kind);
  expect_verdict("B2", Measured{damped(0.3), damped(0.31), damped(0.4)}, Verdict::not_reproduced);
}

TEST(ClaimRules, B3AddedPoints) {
  expect_verdict("B3", {{"depth_before", 21}, {"depth_after", 23}, {"direction_product", -1}}, Verdict::reproduced);
  expect_verdict("B3", {{"depth_before", 21}, {"depth_after", 22}, {"direction_product", -1}}, Verdict::in_kind);
  expect_verdict("B3", {{"depth_before", 21}, {"depth_after", 23}, {"direction_product", 1}}, Verdict::not_reproduced);
}

TEST(ClaimRules, F1NormalProjection) {
  const auto press = [](double step, double depth) -> std::map<std::string, double> {
    return {{"step", step}, {"step_shortest", 0.3}, {"pressed", 8e-4}, {"depth", depth}, {"depth_shortest", 5e-4}};
  };
  expect_verdict("F1", press(7, 8e-4), Verdict::reproduced);
  expect_verdict("F1", press(7, 5e-4), Verdict::in_kind);
  expect_verdict("F1", press(1, 8e-4), Verdict::not_reproduced);
}

TEST(ClaimRules, F2Tandpasta) {
  const auto boosted = [](double energy, double least) {
    return Measured{{"",
                     {{"energy_ratio", {energy}},
                      {"boosts", {5.0, least, 4.0}},
                      {"tandpasta", {0.3}},
                      {"summation", {0.2}},
                      {"shaped_stiffness", {0.25}}}}};
  };
  expect_verdict("F2", boosted(1.0, 2.0), Verdict::reproduced);
  expect_verdict("F2", boosted(1.0, 1.9), Verdict::in_kind);
  expect_verdict("F2", boosted(1.0, 0.9), Verdict::not_reproduced);
  expect_verdict("F2", boosted(1.1, 2.0), Verdict::not_reproduced);
}

MeasuredCase rate(std::vector<double> original, std::vector<double> shaped) {
  return {"success rate", {{"original", std::move(original)}, {"shaped", std::move(shaped)}}};
}
MeasuredCase speed(std::vector<double> original, std::vector<double> shaped) {
  return {"speed", {{"original", std::move(original)}, {"shaped", std::move(shaped)}}};
}

TEST(ClaimRules, D1ToD4Experiments) {
  // Published of D1: rates 0.32 ± 0.09 and 0.97 ± 0.02, speeds 0.009 and 0.002 m/s; of D2: rates 0.64 ± 0.13 and
  // 0.63 ± 0.19, speeds 0.002 and 0.002, no difference.
  const MeasuredCase better = rate({0.2, 0.3, 0.4}, {0.9, 1.0, 1.0}), alike = rate({0.5, 0.6, 0.4}, {0.6, 0.4, 0.5});
  const MeasuredCase worse = rate({0.9, 1.0, 1.0}, {0.2, 0.3, 0.4}), far = rate({0.6, 0.65, 0.7}, {0.9, 1.0, 1.0});
  const MeasuredCase slower = speed({9e-3, 8e-3, 8.5e-3}, {2e-3, 2e-3, 2e-3});
  const MeasuredCase faster = speed({1, 1.1, 0.9}, {2, 2, 2});
  expect_verdict("D1", Measured{better, slower}, Verdict::reproduced);
  expect_verdict("D1", Measured{better, faster}, Verdict::in_kind);
  expect_verdict("D1", Measured{far, slower}, Verdict::in_kind);
  expect_verdict("D1", Measured{alike, slower}, Verdict::not_reproduced);
  expect_verdict("D1", Measured{worse, slower}, Verdict::not_reproduced);
  expect_verdict("D2", Measured{better}, Verdict::not_reproduced);
  expect_verdict("D2", Measured{alike}, Verdict::reproduced);
  // Both would be printed as 0.002: no difference, though it is significant; and one that would not.
  expect_verdict("D2", Measured{alike, speed({1.6e-3, 1.7e-3, 1.65e-3}, {2.1e-3, 2.2e-3, 2.15e-3})},
                 Verdict::reproduced);
  expect_verdict("D2", Measured{alike, speed({1.6e-3, 1.7e-3, 1.65e-3}, {3.1e-3, 3.2e-3, 3.15e-3})}, Verdict::in_kind);
  expect_verdict("D4", Measured{better, slower}, Verdict::reproduced);
}

TEST(ClaimRules, D6Thresholds) {
  const auto place = [](const char* pilot, double value, double original, double shaped = 1.0) -> MeasuredCase {
    return {pilot, {{"value", {value}}, {"original", {original}}, {"shaped", {shaped}}}};
  };
  const auto pilots = [&](double hard_offset, double hard_height) {
    return Measured{place("offset", 0.4e-3, 0.9), place("offset", 0.6e-3, hard_offset),
                    place("height", 2e-3, hard_height), place("height", 4e-3, 0.9)};
  };
  expect_verdict("D6", pilots(0.1, 0.1), Verdict::reproduced);
  expect_verdict("D6", pilots(0.1, 0.2), Verdict::in_kind);
  expect_verdict("D6", pilots(0.2, 0.2), Verdict::not_reproduced);
  // A threshold further out than the published one.
  Measured further = pilots(0.5, 0.5);
  further.push_back(place("offset", 0.7e-3, 0.0));
  expect_verdict("D6", further, Verdict::in_kind);
  // Nobody can remove that one.
  further.back() = place("offset", 0.7e-3, 0.0, 0.0);
  expect_verdict("D6", further, Verdict::not_reproduced);
}

}  // namespace
}  // namespace hapbench::claim_rules_appendices_test
