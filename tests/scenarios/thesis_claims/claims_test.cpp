#include "scenarios/thesis_claims/claims.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <set>

#include "scenarios/input/json_file.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Every rule, by its claim's own record, with numbers made up to pass and numbers made up to fail.
namespace hapbench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

const Claim& claim(const std::string& id) {
  static const std::vector<Claim> claims = all_claims();
  for (const Claim& c : claims) {
    if (c.id == id) return c;
  }
  throw std::out_of_range(id);
}

const PublishedNumbers& published() {
  static const PublishedNumbers numbers(HAPBENCH_SCENARIOS "/../results/reference/published");
  return numbers;
}

void expect_verdict(const std::string& id, const Measured& measured, Verdict verdict) {
  const Finding finding = claim(id).judge(measured, published());
  EXPECT_EQ(finding.verdict, verdict) << id << ": " << finding.measured << " / " << finding.why;
  EXPECT_FALSE(finding.measured.empty()) << id;
  EXPECT_FALSE(finding.why.empty()) << id;
}

/// Of a claim with a single case.
void expect_verdict(const std::string& id, const std::map<std::string, double>& values, Verdict verdict) {
  MeasuredCase single;
  for (const auto& [name, value] : values) single.values[name] = {value};
  expect_verdict(id, Measured{single}, verdict);
}

MeasuredCase counts(const char* density, double raw, double reduced, double reduced_max) {
  return {density, {{"raw_mean", {raw}}, {"reduced_mean", {reduced}}, {"reduced_max", {reduced_max}}}};
}

TEST(ClaimRules, T1FlatReduction) {
  expect_verdict("T1", Measured{counts("a", 40, 1, 1), counts("b", 40, 1, 1)}, Verdict::reproduced);
  expect_verdict("T1", Measured{counts("a", 40, 1, 1), counts("b", 40, 1.1, 2)}, Verdict::not_reproduced);
}

TEST(ClaimRules, T2AndT3ReducedPoints) {
  // Published: 6.21 +- 1.7 and 5.5 +- 1.9.
  expect_verdict("T2", Measured{counts("a", 40, 15, 30), counts("b", 40, 7.8, 12)}, Verdict::reproduced);
  expect_verdict("T2", Measured{counts("a", 40, 15, 30), counts("b", 40, 8.0, 12)}, Verdict::in_kind);
  expect_verdict("T2", Measured{counts("a", 40, 21, 30), counts("b", 40, 8.0, 12)}, Verdict::not_reproduced);
  // Published: 6.5 +- 2.1 and 5.2 +- 1.7, below 15.
  expect_verdict("T3", Measured{counts("a", 40, 6, 15)}, Verdict::in_kind);
  expect_verdict("T3", Measured{counts("a", 40, 6, 14)}, Verdict::reproduced);
  expect_verdict("T3", Measured{counts("a", 40, 8.7, 14)}, Verdict::in_kind);
}

TEST(ClaimRules, T4Deadline) {
  expect_verdict("T4", {{"matrix", 1.3e-3}, {"reduced", 5e-6}, {"tensor", 2e-6}}, Verdict::reproduced);
  expect_verdict("T4", {{"matrix", 3e-4}, {"reduced", 5e-6}, {"tensor", 2e-6}}, Verdict::in_kind);
  expect_verdict("T4", {{"matrix", 1.3e-3}, {"reduced", 6e-4}, {"tensor", 2e-6}}, Verdict::not_reproduced);
}

TEST(ClaimRules, R1FirstRatios) {
  expect_verdict("R1", {{"first_min", 0.81}, {"first_max", 1.29}, {"any_max", 1.4}}, Verdict::reproduced);
  expect_verdict("R1", {{"first_min", 0.79}, {"first_max", 1.29}, {"any_max", 1.4}}, Verdict::in_kind);
  expect_verdict("R1", {{"first_min", 0.81}, {"first_max", 1.31}, {"any_max", 1.4}}, Verdict::in_kind);
  expect_verdict("R1", {{"first_min", 0.81}, {"first_max", 1.29}, {"any_max", 1.51}}, Verdict::not_reproduced);
}

TEST(ClaimRules, R1bRatioLimit) {
  expect_verdict("R1b", {{"last_max", 1.005}, {"limit_max", 1.009}}, Verdict::reproduced);
  expect_verdict("R1b", {{"last_max", 1.3}, {"limit_max", 1.3}}, Verdict::refuted);
}

TEST(ClaimRules, L1ForceLimit) {
  const auto curve = [](double slope, double onset, double spread) -> std::map<std::string, double> {
    return {{"slope_times_stiffness", slope}, {"onset", onset}, {"plateau_spread", spread}};
  };
  expect_verdict("L1", curve(1.01, 2.75, 0.01), Verdict::reproduced);
  expect_verdict("L1", curve(1.01, 2.0, 0.01), Verdict::in_kind);
  expect_verdict("L1", curve(1.01, kNever, 0.5), Verdict::not_reproduced);
  expect_verdict("L1", curve(0.5, 2.7, 0.01), Verdict::not_reproduced);
}

TEST(ClaimRules, J1IdealTrajectory) {
  const auto errors = [](double height, double high, double high_max) -> std::map<std::string, double> {
    return {{"low_height_rms", height},
            {"low_lateral_rms", 1e-4},
            {"low_interpenetration", 1e-5},
            {"high_interpenetration", high},
            {"high_interpenetration_max", high_max}};
  };
  expect_verdict("J1", errors(2e-4, 1e-4, 2.4e-4), Verdict::reproduced);
  expect_verdict("J1", errors(2e-4, 3e-4, 9e-4), Verdict::in_kind);
  expect_verdict("J1", errors(7e-4, 1e-4, 2.4e-4), Verdict::not_reproduced);
}

TEST(ClaimRules, A1PegMotion) {
  const auto motions = [](double original, double shaped) {
    return Measured{{"original", {{"velocity_variation", {original}}, {"force_reversals", {40}}}},
                    {"shaped", {{"velocity_variation", {shaped}}, {"force_reversals", {6}}}}};
  };
  expect_verdict("A1", motions(3.0, 0.1), Verdict::reproduced);
  expect_verdict("A1", motions(0.2, 0.1), Verdict::in_kind);
  expect_verdict("A1", motions(0.1, 0.2), Verdict::not_reproduced);
}

TEST(ClaimRules, A2SpringsUnlimited) {
  const MeasuredCase good{"good", {{"settling", {0.1}}}}, bad{"bad", {{"settling", {kNever}}}};
  expect_verdict("A2", Measured{good, good, good}, Verdict::reproduced);
  expect_verdict("A2", Measured{good, good, bad}, Verdict::in_kind);
  expect_verdict("A2", Measured{good, bad, bad}, Verdict::not_reproduced);
}

TEST(ClaimRules, A3SpringsLimited) {
  const auto runs = [](double proposed, double other) {
    return Measured{{"shaped_stiffness", {{"unlimited", {0.020}}, {"limited", {proposed}}}},
                    {"other", {{"unlimited", {0.020}}, {"limited", {other}}}}};
  };
  expect_verdict("A3", runs(0.021, 0.031), Verdict::reproduced);
  expect_verdict("A3", runs(0.021, kNever), Verdict::reproduced);
  expect_verdict("A3", runs(0.021, 0.021), Verdict::in_kind);
  expect_verdict("A3", runs(0.030, 0.031), Verdict::not_reproduced);
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

TEST(ClaimRules, B2OriginalDamping) {
  expect_verdict("B2", {{"along", 0.25}, {"across", 0}, {"angle_degrees", 60}}, Verdict::reproduced);
  expect_verdict("B2", {{"along", 0.75}, {"across", 0}, {"angle_degrees", 30}}, Verdict::in_kind);
  expect_verdict("B2", {{"along", 1.0}, {"across", 0}, {"angle_degrees", 0}}, Verdict::not_reproduced);
}

TEST(ClaimRules, B3AddedPoints) {
  expect_verdict("B3", {{"depth_before", 21}, {"depth_after", 23}, {"direction_product", -1}}, Verdict::reproduced);
  expect_verdict("B3", {{"depth_before", 21}, {"depth_after", 22}, {"direction_product", -1}}, Verdict::in_kind);
  expect_verdict("B3", {{"depth_before", 21}, {"depth_after", 23}, {"direction_product", 1}}, Verdict::not_reproduced);
}

TEST(ClaimRules, G1MedianLine) {
  const auto products = [](double shortest, double underestimated) -> std::map<std::string, double> {
    return {{"shortest_product", shortest}, {"normal_product", 1}, {"underestimated_by", underestimated}};
  };
  expect_verdict("G1", products(-1, 0.03), Verdict::reproduced);
  expect_verdict("G1", products(-1, 0.2), Verdict::in_kind);
  expect_verdict("G1", products(1, 0.03), Verdict::not_reproduced);
}

TEST(ClaimRules, C1OverReduction) {
  expect_verdict("C1", {{"reduced_max", 1}, {"unreduced_max", 100}, {"force_difference", 0.5}}, Verdict::reproduced);
  expect_verdict("C1", {{"reduced_max", 1}, {"unreduced_max", 100}, {"force_difference", 0.01}}, Verdict::in_kind);
  expect_verdict("C1", {{"reduced_max", 2}, {"unreduced_max", 100}, {"force_difference", 0.5}},
                 Verdict::not_reproduced);
  expect_verdict("C1", {{"reduced_max", 1}, {"unreduced_max", 9}, {"force_difference", 0.5}}, Verdict::not_reproduced);
}

TEST(ClaimRules, C2PureRotation) {
  expect_verdict("C2", {{"rotation_work", 1e-3}, {"damping_work", 0.0}}, Verdict::reproduced);
  expect_verdict("C2", {{"rotation_work", 1e-3}, {"damping_work", -1e-6}}, Verdict::in_kind);
  expect_verdict("C2", {{"rotation_work", 0.0}, {"damping_work", 0.0}}, Verdict::not_reproduced);
}

TEST(ClaimRules, C3ParallelFaces) {
  const auto faces = [](double depth, double force) -> std::map<std::string, double> {
    return {{"depth", depth}, {"radius", 5e-4}, {"force", force}, {"one_wall_force", 10}};
  };
  expect_verdict("C3", faces(5e-4, 0.05), Verdict::reproduced);
  expect_verdict("C3", faces(1e-4, 0.05), Verdict::in_kind);
  expect_verdict("C3", faces(5e-4, 1.0), Verdict::not_reproduced);
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
  expect_verdict("F2", {{"energy_ratio", 1.0}, {"steps", 5}, {"steps_shaped", 500}}, Verdict::reproduced);
  expect_verdict("F2", {{"energy_ratio", 1.1}, {"steps", 5}, {"steps_shaped", 500}}, Verdict::in_kind);
  expect_verdict("F2", {{"energy_ratio", 1.1}, {"steps", 400}, {"steps_shaped", 500}}, Verdict::not_reproduced);
}

MeasuredCase rate(std::vector<double> original, std::vector<double> shaped) {
  return {"success rate", {{"original", std::move(original)}, {"shaped", std::move(shaped)}}};
}
MeasuredCase speed(std::vector<double> original, std::vector<double> shaped) {
  return {"speed", {{"original", std::move(original)}, {"shaped", std::move(shaped)}}};
}

TEST(ClaimRules, D1ToD4Experiments) {
  // Published of D1: rates 0.32 +- 0.09 and 0.97 +- 0.02, speeds 0.009 and 0.002 m/s; of D2: rates 0.64 +- 0.13 and
  // 0.63 +- 0.19, no difference.
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
  expect_verdict("D4", Measured{better, slower}, Verdict::reproduced);
}

TEST(ClaimRules, C4AndD5AreNotForASimulation) {
  for (const char* id : {"C4", "D5"}) {
    const Finding finding = claim(id).judge({}, published());
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
    EXPECT_EQ(ledger[i].at("published"), claims[i].published) << claims[i].id;
    EXPECT_EQ(ledger[i].at("rule"), claims[i].rule(published())) << claims[i].id;
  }
}

TEST(Wording, SpellsThresholds) {
  EXPECT_EQ(in_words(0.5), "half");
  EXPECT_EQ(in_words(5.0), "five");
  EXPECT_EQ(in_words(7.5), "7.5");
  EXPECT_EQ(percent(0.02), "2 %");
  EXPECT_EQ(percent(0.005), "0.5 %");
  EXPECT_EQ(plain(1e-9), "1e-9");
  EXPECT_EQ(plain(1e-12), "1e-12");
  EXPECT_EQ(plain(15.0), "15");
}

TEST(VerdictName, IsThatOfTheLedger) {
  EXPECT_EQ(verdict_name(Verdict::reproduced), "reproduced");
  EXPECT_EQ(verdict_name(Verdict::in_kind), "reproduced in kind");
  EXPECT_EQ(verdict_name(Verdict::not_reproduced), "not reproduced");
  EXPECT_EQ(verdict_name(Verdict::refuted), "refuted");
  EXPECT_EQ(verdict_name(Verdict::not_reproducible), "not reproducible");
}

}  // namespace
}  // namespace hapbench
