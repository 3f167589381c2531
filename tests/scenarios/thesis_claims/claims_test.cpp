#include "scenarios/thesis_claims/claims.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis_claims/choices.hpp"

namespace hapbench::claims_test {
namespace {

const Claim& claim(const std::string& id) {
  static const std::vector<Claim> claims = all_claims();
  for (const Claim& c : claims) {
    if (c.id == id) return c;
  }
  throw std::out_of_range(id);
}

const PublishedNumbers& published() {
  static const std::filesystem::path reference = HAPBENCH_SCENARIOS "/../results/reference";
  static const Choices choices(reference / "choices.json");
  static const PublishedNumbers numbers =
      choices.with_numbers(PublishedNumbers(reference / "published.json"), choices.values_on_record());
  return numbers;
}

void expect_verdict(const std::string& id, const Measured& measured, Verdict verdict) {
  const Finding finding = claim(id).judge(measured, published());
  EXPECT_EQ(finding.verdict, verdict) << id << ": " << finding.measured << " / " << finding.why;
  EXPECT_FALSE(finding.measured.empty()) << id;
  EXPECT_FALSE(finding.why.empty()) << id;
}

/// The same for a claim with a single case.
void expect_verdict(const std::string& id, const std::map<std::string, double>& values, Verdict verdict) {
  MeasuredCase single;
  for (const auto& [name, value] : values) single.values[name] = {value};
  expect_verdict(id, Measured{single}, verdict);
}

constexpr double kNever = std::numeric_limits<double>::infinity();

MeasuredCase counts(double raw, double raw_spread, double reduced, double reduced_spread, double reduced_max) {
  return {"",
          {{"raw_mean", {raw}},
           {"raw_deviation", {raw_spread}},
           {"reduced_mean", {reduced}},
           {"reduced_deviation", {reduced_spread}},
           {"reduced_max", {reduced_max}}}};
}

TEST(ClaimRules, T1FlatReduction) {
  expect_verdict("T1", Measured{counts(40, 10, 1, 0, 1), counts(40, 10, 1, 0, 1)}, Verdict::reproduced);
  expect_verdict("T1", Measured{counts(40, 10, 1, 0, 1), counts(40, 10, 1.1, 0, 2)}, Verdict::not_reproduced);
}

TEST(ClaimRules, T2AndT3ReducedPoints) {
  // Published: raw 37.8 ± 17.7 and 34.1 ± 19.5, reduced 6.21 ± 1.7 and 5.5 ± 1.9, so near is within 3.7, 1.8, 0.71,
  // 0.2.
  const MeasuredCase good = counts(41, 19, 6.9, 1.8, 14);
  expect_verdict("T2", Measured{good, good}, Verdict::reproduced);
  expect_verdict("T2", Measured{good, counts(41, 19, 6.9, 1.8, 15)}, Verdict::in_kind);
  expect_verdict("T2", Measured{counts(41, 19, 6.9, 3.1, 14)}, Verdict::in_kind);
  expect_verdict("T2", Measured{counts(41, 19, 7.0, 1.8, 14)}, Verdict::not_reproduced);
  expect_verdict("T2", Measured{counts(42, 19, 6.9, 1.8, 14)}, Verdict::not_reproduced);
  expect_verdict("T2", Measured{counts(41, 22, 6.9, 1.8, 14)}, Verdict::not_reproduced);
  // The raw counts of one recording do not go with the reduced ones of the other.
  expect_verdict("T2", Measured{counts(41, 19, 4.9, 1.8, 14)}, Verdict::not_reproduced);
  // Published: raw 231.5 ± 116.1 and 163.7 ± 103.1, reduced 6.5 ± 2.1 and 5.2 ± 1.7, below 15.
  expect_verdict("T3", Measured{counts(200, 110, 6, 2, 14)}, Verdict::reproduced);
  expect_verdict("T3", Measured{counts(200, 110, 6, 2, 15)}, Verdict::in_kind);
  expect_verdict("T3", Measured{counts(50, 110, 6, 2, 14)}, Verdict::not_reproduced);
}

TEST(ClaimRules, T2bHands) {
  const auto hand = [](double raw) { return MeasuredCase{"", {{"raw", {raw}}, {"kept", {20}}}}; };
  expect_verdict("T2b", Measured{hand(55), hand(56)}, Verdict::holds);
  expect_verdict("T2b", Measured{hand(56), hand(57)}, Verdict::does_not_hold);
}

TEST(ClaimRules, T4Deadline) {
  expect_verdict("T4", {{"points", 1000}, {"matrix", 1.3e-3}, {"reduced", 5e-6}, {"tensor", 2e-6}},
                 Verdict::reproduced);
  expect_verdict("T4", {{"points", 1000}, {"matrix", 3e-4}, {"reduced", 5e-6}, {"tensor", 2e-6}}, Verdict::in_kind);
  expect_verdict("T4", {{"points", 1000}, {"matrix", 1.3e-3}, {"reduced", 6e-4}, {"tensor", 2e-6}},
                 Verdict::not_reproduced);
  expect_verdict("T4b", {{"points", 1000}, {"matrix", 1.3e-3}, {"reduced", 5e-6}, {"tensor", 2e-6}}, Verdict::holds);
  expect_verdict("T4b", {{"points", 1000}, {"matrix", 1.3e-3}, {"reduced", 5e-6}, {"tensor", 6e-4}},
                 Verdict::does_not_hold);
}

TEST(ClaimRules, T5LoopLoad) {
  const auto loads = [](double without_iterations, double unreduced) -> std::map<std::string, double> {
    return {{"points", 500},
            {"reduced_0", without_iterations},
            {"reduced_3", 0.02},
            {"unreduced_3", unreduced},
            {"tensor_reduced_3", 0.01},
            {"tensor_unreduced_3", 0.005}};
  };
  expect_verdict("T5", loads(0.015, 0.5), Verdict::reproduced);
  expect_verdict("T5", loads(0.005, 0.5), Verdict::in_kind);
  expect_verdict("T5", loads(0.015, 0.01), Verdict::in_kind);
  expect_verdict("T5", loads(0.005, 0.01), Verdict::not_reproduced);
}

TEST(ClaimRules, R1AndR3Ratios) {
  const auto ratios = [](double inside, double any_max) {
    const auto task = [any_max](double share) {
      return MeasuredCase{"", {{"inside", {share}}, {"min", {0.7}}, {"max", {1.2}}, {"any_max", {any_max}}}};
    };
    return Measured{task(1.0), task(inside)};
  };
  for (const char* id : {"R1", "R3"}) {
    expect_verdict(id, ratios(0.96, 1.4), Verdict::reproduced);
    expect_verdict(id, ratios(0.94, 1.4), Verdict::in_kind);
    expect_verdict(id, ratios(0.49, 1.4), Verdict::not_reproduced);
    expect_verdict(id, ratios(0.96, 1.51), Verdict::not_reproduced);
  }
}

TEST(ClaimRules, R2Guarantee) {
  const auto found = [](double largest) {
    return Measured{{"1", {{"lambda_max", {1.366}}, {"sets", {100}}}},
                    {"limit", {{"lambda_max", {largest}}, {"sets", {100}}}}};
  };
  expect_verdict("R2", found(1.36), Verdict::reproduced);
  expect_verdict("R2", found(1.51), Verdict::not_reproduced);
}

TEST(ClaimRules, R1bRatioLimit) {
  expect_verdict("R1b", {{"last_max", 1.005}, {"limit_max", 1.009}}, Verdict::reproduced);
  expect_verdict("R1b", {{"last_max", 1.3}, {"limit_max", 1.3}}, Verdict::refuted);
}

TEST(ClaimRules, L1ForceLimit) {
  const auto curve = [](double deviation, double onset, double spread) -> std::map<std::string, double> {
    return {{"deviation", deviation}, {"onset", onset}, {"plateau_spread", spread}};
  };
  expect_verdict("L1", curve(0.01, 2.75, 0.01), Verdict::reproduced);
  expect_verdict("L1", curve(0.01, 2.0, 0.01), Verdict::in_kind);
  expect_verdict("L1", curve(0.01, kNever, 0.5), Verdict::not_reproduced);
  expect_verdict("L1", curve(0.03, 2.7, 0.01), Verdict::not_reproduced);
}

TEST(ClaimRules, L2SaturatedMotion) {
  const auto shares = [](double all, double reached) {
    const auto rows = [](double against) {
      return MeasuredCase{"", {{"rows", {100}}, {"against", {against}}, {"uphill", {0.1}}}};
    };
    return Measured{rows(all), rows(reached)};
  };
  expect_verdict("L2", shares(0.96, 0.96), Verdict::reproduced);
  expect_verdict("L2", shares(0.94, 0.96), Verdict::in_kind);
  expect_verdict("L2", shares(0.94, 0.94), Verdict::not_reproduced);
  // No such row: nothing is shown.
  expect_verdict("L2", shares(std::nan(""), std::nan("")), Verdict::not_reproduced);
}

TEST(ClaimRules, L3Shaking) {
  const auto at = [](double frequency, double mass, double force) {
    return MeasuredCase{"",
                        {{"frequency", {frequency}}, {"mass", {mass}}, {"mass_unlimited", {0.1}}, {"force", {force}}}};
  };
  expect_verdict("L3", Measured{at(2, 0.1, 0.5), at(4, 0.7, 20)}, Verdict::reproduced);
  expect_verdict("L3", Measured{at(2, 0.12, 0.5), at(4, 0.7, 20)}, Verdict::in_kind);
  expect_verdict("L3", Measured{at(2, 0.1, 2.1), at(4, 0.7, 20)}, Verdict::in_kind);
  expect_verdict("L3", Measured{at(2, 0.1, 0.5), at(4, 0.15, 20)}, Verdict::not_reproduced);
}

TEST(ClaimRules, J1IdealTrajectory) {
  const auto hand = [](double force, double height, double lateral, double inside) {
    return MeasuredCase{"", {{"force", {force}}, {"height", {height}}, {"lateral", {lateral}}, {"inside", {inside}}}};
  };
  // Published: 0.25 mm, both; "around" is 0.3 mm.
  const MeasuredCase gentle = hand(0.2, -2.9e-4, 2e-4, 2.9e-4);
  expect_verdict("J1", Measured{gentle, hand(2.5, -3e-4, 2.9e-4, 1e-3)}, Verdict::in_kind);
  expect_verdict("J1", Measured{gentle, hand(2.5, -3e-4, 3.1e-4, 1e-4)}, Verdict::not_reproduced);
  expect_verdict("J1", Measured{gentle, hand(2.5, -2e-4, 2e-4, 1e-4)}, Verdict::not_reproduced);
  expect_verdict("J1", Measured{hand(0.2, -3.1e-4, 2e-4, 1e-4), hand(2.5, -4e-4, 2e-4, 1e-4)}, Verdict::not_reproduced);
  expect_verdict("J1", Measured{hand(0.2, -1e-4, 2e-4, 3.1e-4), hand(2.5, -4e-4, 2e-4, 1e-4)}, Verdict::not_reproduced);
  expect_verdict("J2", {{"tilt", 1.0472}}, Verdict::reproduced);
  expect_verdict("J2", {{"tilt", 1.0476}}, Verdict::not_reproduced);
}

TEST(ClaimRules, G1MedianLine) {
  const auto products = [](double shortest, double normal) -> std::map<std::string, double> {
    return {{"shortest_product", shortest}, {"normal_product", normal}};
  };
  expect_verdict("G1", products(-1, 1), Verdict::reproduced);
  expect_verdict("G1", products(-1, 0.9), Verdict::in_kind);
  expect_verdict("G1", products(1, 1), Verdict::not_reproduced);
}

TEST(ClaimRules, G1bUnderestimation) {
  const auto effect = [](double force, double way, double depth) -> std::map<std::string, double> {
    return {{"contacts", 100}, {"depth_mean", 1e-6}, {"depth_95", depth}, {"depth_max", 5e-5},
            {"share", 0.1},    {"force", force},     {"way", way}};
  };
  // 5 % of 0.25 mm are 12.5 µm.
  expect_verdict("G1b", effect(0.05, 1.2e-5, 2e-5), Verdict::reproduced);
  expect_verdict("G1b", effect(0.06, 1.2e-5, 2e-5), Verdict::in_kind);
  expect_verdict("G1b", effect(0.06, 1.3e-5, 1.2e-5), Verdict::in_kind);
  expect_verdict("G1b", effect(0.06, 1.3e-5, 1.3e-5), Verdict::not_reproduced);
}

TEST(ClaimRules, G2AndF3Costs) {
  const auto cost = [](double projection) -> std::map<std::string, double> {
    return {{"normal_projection", projection}, {"surface_normal", 1e-9}};
  };
  expect_verdict("G2", cost(1e-8), Verdict::reproduced);
  expect_verdict("G2", cost(9e-9), Verdict::in_kind);
  expect_verdict("G2", cost(1e-9), Verdict::not_reproduced);
  const auto share = [](double tandpasta) -> std::map<std::string, double> {
    return {{"points", 90}, {"tandpasta", tandpasta}, {"shaped_stiffness", 0.01}};
  };
  expect_verdict("F3", share(0.1), Verdict::reproduced);
  expect_verdict("F3", share(0.09), Verdict::in_kind);
  expect_verdict("F3", share(0.009), Verdict::not_reproduced);
}

TEST(ClaimRules, C1OverReduction) {
  expect_verdict("C1", {{"reduced_max", 1}, {"unreduced_max", 100}, {"force_difference", 0.5}}, Verdict::reproduced);
  expect_verdict("C1", {{"reduced_max", 1}, {"unreduced_max", 100}, {"force_difference", 0.01}}, Verdict::in_kind);
  expect_verdict("C1", {{"reduced_max", 2}, {"unreduced_max", 100}, {"force_difference", 0.5}},
                 Verdict::not_reproduced);
  expect_verdict("C1", {{"reduced_max", 1}, {"unreduced_max", 9}, {"force_difference", 0.5}}, Verdict::not_reproduced);
}

TEST(ClaimRules, C2AndC7TurnIntoWall) {
  const auto turned = [](double variation, double reversals) {
    return MeasuredCase{
        "", {{"velocity_variation", {variation}}, {"vibration_power", {1e-6}}, {"force_reversals", {reversals}}}};
  };
  expect_verdict("C2", Measured{turned(0.2, 5), turned(0.1, 0)}, Verdict::reproduced);
  expect_verdict("C2", Measured{turned(0.2, 0), turned(0.1, 0)}, Verdict::in_kind);
  expect_verdict("C2", Measured{turned(0.19, 5), turned(0.1, 0)}, Verdict::in_kind);
  expect_verdict("C2", Measured{turned(0.1, 5), turned(0.1, 0)}, Verdict::not_reproduced);
  expect_verdict("C7", Measured{turned(0.19, 0), turned(0.1, 0)}, Verdict::reproduced);
  expect_verdict("C7", Measured{turned(0.2, 0), turned(0.1, 0)}, Verdict::in_kind);
  expect_verdict("C7", Measured{turned(0.2, 1), turned(0.1, 0)}, Verdict::not_reproduced);
}

TEST(ClaimRules, P1C5C6ProposedAlgorithm) {
  const auto density = [](double all, double reduced) {
    return Measured{{"shaped_stiffness", {{"all", {0.0, all}}, {"reduced", {0.0, reduced}}}}};
  };
  expect_verdict("P1", density(0.05, 0.05), Verdict::reproduced);
  expect_verdict("P1", density(0.06, 0.05), Verdict::in_kind);
  expect_verdict("P1", density(0.06, 0.06), Verdict::not_reproduced);
  const auto change = [](double shaped) {
    return Measured{{"shaped_stiffness", {{"change", {shaped}}}}, {"mean", {{"change", {0.3}}}}};
  };
  expect_verdict("C5", change(0.05), Verdict::reproduced);
  expect_verdict("C5", change(0.2), Verdict::in_kind);
  expect_verdict("C5", change(0.4), Verdict::not_reproduced);
  const auto damping = [](double of_four) {
    return Measured{{"1", {{"count", {1}}, {"damping_ratio", {0.1}}}},
                    {"4", {{"count", {4}}, {"damping_ratio", {of_four}}}}};
  };
  expect_verdict("C6", damping(0.209), Verdict::reproduced);
  expect_verdict("C6", damping(0.1), Verdict::not_reproduced);
}

TEST(ClaimRules, V1AndV2Penetration) {
  const auto depths = [](double depth) { return MeasuredCase{"", {{"depth", {depth, depth, depth}}}}; };
  expect_verdict("V1", Measured{depths(1e-4), depths(2e-4)}, Verdict::reproduced);
  expect_verdict("V1", Measured{depths(1e-4), depths(1.9e-4)}, Verdict::in_kind);
  expect_verdict("V1", Measured{depths(1e-4), {"", {{"depth", {5e-4, 5e-4, 0.9e-4}}}}}, Verdict::not_reproduced);
  expect_verdict("V2", Measured{depths(1e-4), depths(2e-4)}, Verdict::reproduced);
  expect_verdict("V2", Measured{depths(1e-4), depths(0.9e-4)}, Verdict::not_reproduced);
  expect_verdict("V2b", Measured{depths(1e-4), depths(3e-4), depths(2e-4), depths(1e-4)}, Verdict::holds);
  expect_verdict("V2b", Measured{depths(1e-4), depths(1e-4), depths(2e-4), depths(1e-4)}, Verdict::does_not_hold);
  const auto deepest = [](double depth) { return MeasuredCase{"", {{"depth", {depth}}}}; };
  expect_verdict("B1b", Measured{deepest(1e-4), deepest(2e-4)}, Verdict::reproduced);
  expect_verdict("B1b", Measured{deepest(1e-4), deepest(1.9e-4)}, Verdict::in_kind);
  expect_verdict("B1b", Measured{deepest(1e-4), deepest(1e-4)}, Verdict::not_reproduced);
}

TEST(ClaimRules, S1Summation) {
  const auto run = [](double variation, double diverges) {
    return MeasuredCase{"",
                        {{"velocity_variation", {variation}},
                         {"vibration_power", {variation * variation}},
                         {"force_reversals", {0}},
                         {"diverges", {diverges}}}};
  };
  const MeasuredCase smooth = run(0.1, 0), rough = run(0.6, 0), diverging = run(0.1, 1);
  expect_verdict("S1", Measured{rough, smooth, diverging, smooth}, Verdict::reproduced);
  expect_verdict("S1", Measured{smooth, smooth, diverging, smooth}, Verdict::in_kind);
  expect_verdict("S1", Measured{smooth, smooth, run(0.49, 0), smooth}, Verdict::not_reproduced);
}

TEST(ClaimRules, C3ParallelFaces) {
  const auto faces = [](double depth, double force) -> std::map<std::string, double> {
    return {{"depth", depth}, {"radius", 5e-4}, {"force", force}, {"one_wall_force", 10}};
  };
  expect_verdict("C3", faces(5e-4, 0.05), Verdict::reproduced);
  expect_verdict("C3", faces(1e-4, 0.05), Verdict::in_kind);
  expect_verdict("C3", faces(5e-4, 1.0), Verdict::not_reproduced);
}

TEST(ClaimRules, C4AndD5AreNotForASimulation) {
  for (const char* id : {"C4", "D5"}) {
    const Finding finding = claim(id).finding({published(), {}, {}});
    EXPECT_EQ(finding.verdict, Verdict::not_reproducible) << id;
    EXPECT_FALSE(finding.why.empty()) << id;
  }
}

TEST(Claims, HaveUniqueIds) {
  std::set<std::string> ids;
  for (const Claim& c : all_claims()) EXPECT_TRUE(ids.insert(c.id).second) << c.id;
}

/// The rules' texts are written from the thresholds, so this is also a test of those.
TEST(Claims, AreThoseOfTheLedger) {
  const Json ledger =
      parse_json(read_text_file(HAPBENCH_SCENARIOS "/../results/reference/claims.json", kLargestJsonFile)).at("claims");
  const std::vector<Claim> claims = all_claims();
  ASSERT_EQ(ledger.size(), claims.size());
  for (std::size_t i = 0; i < claims.size(); ++i) {
    EXPECT_EQ(ledger[i].at("id"), claims[i].id);
    EXPECT_EQ(ledger[i].at("claim"), claims[i].claim) << claims[i].id;
    EXPECT_EQ(ledger[i].at("published"), published().fill(claims[i].published)) << claims[i].id;
    EXPECT_EQ(ledger[i].at("rule"), published().fill(claims[i].rule)) << claims[i].id;
  }
}

TEST(Wording, SpellsThresholds) {
  EXPECT_EQ(plain(1e-9), "1e-9");
  EXPECT_EQ(plain(1e-12), "1e-12");
  EXPECT_EQ(plain(15.0), "15");
}

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

MeasuredCase sprung(const char* name, double pairs, double swings, double overshoot = 1e-4, double arrives = 1.0) {
  return {
      name,
      {{"pairs", {pairs}}, {"arrives", {arrives}}, {"overshoot", {overshoot}}, {"swings", {swings}}, {"signed", {1}}}};
}

TEST(ClaimRules, A2SpringsUnlimited) {
  expect_verdict("A2", Measured{sprung("a", 100, 2), sprung("b", 100, 2), sprung("a", 4, 9)}, Verdict::reproduced);
  expect_verdict("A2", Measured{sprung("a", 100, 2), sprung("b", 100, 3), sprung("a", 4, 1)}, Verdict::in_kind);
  expect_verdict("A2", Measured{sprung("a", 100, 2, 0, 0), sprung("a", 4, 3)}, Verdict::not_reproduced);
}

TEST(ClaimRules, A3SpringsLimited) {
  const auto runs = [](double pairs, const MeasuredCase& other, const MeasuredCase& limited,
                       double overshoot = 1.09e-4) {
    return Measured{sprung("shaped_stiffness", pairs, 2), sprung("shaped_stiffness", pairs, 2, overshoot), other,
                    limited};
  };
  expect_verdict("A3", runs(100, sprung("a", 100, 2), sprung("a", 100, 7)), Verdict::reproduced);
  expect_verdict("A3", runs(4, sprung("a", 4, 2), sprung("a", 4, 7)), Verdict::in_kind);
  expect_verdict("A3", runs(100, sprung("a", 100, 2), sprung("a", 100, 6)), Verdict::not_reproduced);
  // It fluctuates without the limits, too.
  expect_verdict("A3", runs(100, sprung("a", 100, 3), sprung("a", 100, 20)), Verdict::not_reproduced);
  expect_verdict("A3", runs(100, sprung("a", 100, 2), sprung("a", 100, 7), 1.11e-4), Verdict::not_reproduced);
}

TEST(ClaimRules, A4StabilityLimits) {
  const auto limits = [](double stiffness, double damping) {
    return Measured{{"K_max (B = 0)", {{"limit", {stiffness}}}}, {"B_max (K = 0)", {{"limit", {damping}}}}};
  };
  expect_verdict("A4", limits(1.01 * 1.6e6, 399), Verdict::reproduced);
  expect_verdict("A4", limits(1.1 * 1.6e6, 399), Verdict::not_reproduced);
  expect_verdict("A4", limits(1.6e6, 520), Verdict::not_reproduced);
  expect_verdict("A5", {{"there", 560}, {"alone", 400}}, Verdict::reproduced);
  expect_verdict("A5", {{"there", 600}, {"alone", 400}}, Verdict::in_kind);
  expect_verdict("A5", {{"there", 390}, {"alone", 400}}, Verdict::not_reproduced);
}

TEST(ClaimRules, B1FlippedGradient) {
  expect_verdict("B1", {{"with_shortest_distance", -1}, {"with_surface_normal", 1}}, Verdict::reproduced);
  expect_verdict("B1", {{"with_shortest_distance", -1}, {"with_surface_normal", -1}}, Verdict::in_kind);
  expect_verdict("B1", {{"with_shortest_distance", 1}, {"with_surface_normal", 1}}, Verdict::not_reproduced);
}

TEST(ClaimRules, B2Groove) {
  const auto damped = [](double original) {
    return MeasuredCase{"", {{"given", {0.7}}, {"groove_frictionoriginal_averaging", {original}}}};
  };
  // What does not swing is not under-damped.
  const MeasuredCase still{"", {{"given", {0.7}}}};
  expect_verdict("B2", Measured{damped(0.3), damped(0.1), damped(0.0)}, Verdict::reproduced);
  expect_verdict("B2", Measured{damped(0.3), still}, Verdict::in_kind);
  expect_verdict("B2", Measured{damped(0.36), still}, Verdict::not_reproduced);
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
MeasuredCase time(std::vector<double> original, std::vector<double> shaped) {
  return {"completion time", {{"original", std::move(original)}, {"shaped", std::move(shaped)}}};
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
  const auto side = [](Measured measured) {
    measured.front().values["reached_at"] = {0.32e-3};
    measured.front().values["wall_at"] = {0.5e-3};
    return measured;
  };
  expect_verdict("D1", side({better, slower}), Verdict::reproduced);
  expect_verdict("D1", side({better, faster}), Verdict::in_kind);
  expect_verdict("D1", side({far, slower}), Verdict::in_kind);
  expect_verdict("D1", side({alike, slower}), Verdict::not_reproduced);
  expect_verdict("D1", side({worse, slower}), Verdict::not_reproduced);
  expect_verdict("D2", Measured{better}, Verdict::not_reproduced);
  expect_verdict("D2", Measured{alike}, Verdict::reproduced);
  // Both would be printed as 0.002: no difference, though it is significant; and one that would not.
  expect_verdict("D2", Measured{alike, speed({1.6e-3, 1.7e-3, 1.65e-3}, {2.1e-3, 2.2e-3, 2.15e-3})},
                 Verdict::reproduced);
  expect_verdict("D2", Measured{alike, speed({1.6e-3, 1.7e-3, 1.65e-3}, {3.1e-3, 3.2e-3, 3.15e-3})}, Verdict::in_kind);
  // Completion times of D2: 6.09 ± 0.92 and 6.47 ± 1.17 s.
  expect_verdict("D2", Measured{alike, time({5, 5.5, 6}, {5.5, 5, 6})}, Verdict::reproduced);
  expect_verdict("D2", Measured{alike, time({3.6, 3.7, 3.8}, {3.8, 3.6, 3.7})}, Verdict::in_kind);
  expect_verdict("D4", Measured{better, slower}, Verdict::reproduced);
  // The rate of D3 is printed as 1.0: its last digit is a tenth.
  expect_verdict("D3", Measured{rate({0.0, 0.0, 0.1}, {1.0, 1.0, 0.9}), slower}, Verdict::reproduced);
  expect_verdict("D3", Measured{rate({0.0, 0.0, 0.1}, {0.7, 0.7, 0.7}), slower}, Verdict::in_kind);
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
}  // namespace hapbench::claims_test
