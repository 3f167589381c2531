#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/thesis/choices.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::claims_test {
namespace {

/// x = exp(-zeta t) cos(sqrt(1 - zeta^2) t), a hundred samples a unit of time.
std::optional<double> measured(double zeta) {
  std::vector<double> x;
  for (int i = 0; i < 3000; ++i) {
    const double t = 0.01 * i;
    x.push_back(std::exp(-zeta * t) * std::cos(std::sqrt(1.0 - zeta * zeta) * t));
  }
  return damping_ratio_of_swings(x);
}

TEST(DampingRatioOfSwings, IsThatOfADampedOscillation) {
  // Sampling misses an extreme by at most half a step: a relative error of its height of (0.005)^2 / 2 ~ 1e-5, which
  // is small beside ln q = pi zeta / sqrt(1 - zeta^2) >= 0.15.
  for (const double zeta : {0.05, 0.1, 0.3, 0.5}) EXPECT_NEAR(measured(zeta).value(), zeta, 1e-3 * zeta) << zeta;
}

TEST(DampingRatioOfSwings, IsZeroForSwingsThatGrow) {
  EXPECT_EQ(measured(-0.01), 0.0);
}

TEST(DampingRatioOfSwings, IsNoneWithoutSwings) {
  EXPECT_FALSE(damping_ratio_of_swings(std::vector<double>(3000, 1.0)));
  EXPECT_FALSE(measured(1.0)) << "it creeps";
}

// The files that claims are judged by.

class ResultFile : public testing::Test {
 protected:
  Evidence evidence() {
    std::filesystem::create_directories(directory_ / "scene");
    return {{}, directory_.path(), [this](const std::string& name) { asked_for_ += name + " "; }};
  }
  std::map<std::string, std::vector<double>> table_of(const std::string& text) {
    const Evidence e = evidence();
    test::write_plainly(directory_ / "scene/trajectory.csv", text);
    return e.table("scene", "trajectory.csv");
  }

  test::TemporaryDirectory directory_;
  std::string asked_for_;
};

TEST_F(ResultFile, IsReadByColumn) {
  const auto table = table_of("time_s,outcome,force_N\n0,completes,1.5\n0.5,,\n");
  EXPECT_EQ(asked_for_, "scene ");
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table.at("time_s"), (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(table.at("force_N")[0], 1.5);
  EXPECT_TRUE(std::isnan(table.at("force_N")[1]));
  EXPECT_TRUE(std::isnan(table.at("outcome")[0]));
}

TEST_F(ResultFile, WithARowThatIsCutOffIsRefusedAndNotPassedOver) {
  const auto error = test::input_error_of([&] { table_of("a,b\n1,2\n3\n"); });
  ASSERT_TRUE(error);
  EXPECT_NE(std::string(error->what()).find("trajectory.csv, line 3: "), std::string::npos) << error->what();
  EXPECT_TRUE(test::input_error_of([&] { table_of(""); }));
}

TEST_F(ResultFile, GivesNumbersOfItsSummary) {
  const Evidence e = evidence();
  test::write_plainly(directory_ / "scene/summary.json", R"({"metrics": {"a": 2, "b": null}, "steps": 7})");
  EXPECT_EQ(e.number("scene", "metrics.a"), 2.0);
  EXPECT_TRUE(std::isnan(e.number("scene", "metrics.b")));
  EXPECT_EQ(e.number("scene", "steps"), 7.0);
  EXPECT_EQ(asked_for_, "scene scene scene ");
}

TEST(PublishedNumbers, FillTextsThatNameThem) {
  const test::TemporaryDirectory directory;
  test::write_plainly(directory / "some.json", R"({"values": [
    {"id": "A.raw", "mean": 37.8, "std": 17.7}, {"id": "B", "value": 0.00025, "at_most": 15}]})");
  const PublishedNumbers numbers(directory / "some.json");
  EXPECT_EQ(numbers.fill("raw <A.raw>, <B*1000 mm"), "raw 37.8 ± 17.7, <B*1000 mm");
  EXPECT_EQ(numbers.fill("<B.mean*1000> mm, <B.at_most>"), "0.25 mm, 15");
  EXPECT_EQ(numbers.fill("<A.raw.spread:.2f>"), "17.70");
  EXPECT_THROW(numbers.fill("<C>"), InputError);
}

const Claim& claim(std::string_view id) {
  static const std::vector<Claim> claims = all_claims();
  for (const Claim& c : claims) {
    if (c.id == id) return c;
  }
  throw std::out_of_range(std::string(id));
}

const PublishedNumbers& published() {
  static const std::filesystem::path reference = HAPBENCH_SCENARIOS "/../../results/reference";
  static const Choices choices(reference / "choices.json");
  static const PublishedNumbers numbers =
      choices.with_numbers(PublishedNumbers(reference / "published.json"), choices.values_on_record());
  return numbers;
}

/// Sets "name=number,number…" in a case, or "1.name=…" in the case of that index; without an index in all that have
/// the name.
void set(Measured& measured, std::string_view text) {
  const bool indexed = text.size() > 1 && text[1] == '.';
  const std::size_t equals = text.find('=');
  const std::string name(text.substr(indexed ? 2 : 0, equals - (indexed ? 2 : 0)));
  std::vector<double> numbers;
  for (const std::string_view number : parts_of(text.substr(equals + 1), ','))
    numbers.push_back(std::stod(std::string(number)));
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const bool meant = indexed ? static_cast<std::size_t>(text[0] - '0') == i : measured[i].values.contains(name);
    if (meant) measured[i].values[name] = numbers;
  }
}

/// Cases "CASE: name=number … | name=number …", each with the name and the numbers of the one before it where its text
/// says nothing else.
Measured cases_in(std::string_view text) {
  Measured measured;
  for (std::string_view part : parts_of(text, '|')) {
    MeasuredCase next = measured.empty() ? MeasuredCase() : measured.back();
    if (const std::size_t colon = part.find(':'); colon != part.npos) {
      const std::size_t begin = part.find_first_not_of(' ');
      next.name = part.substr(begin, colon - begin);
      part.remove_prefix(colon + 1);
    }
    measured.push_back(next);
    const std::string index = std::to_string(measured.size() - 1) + ".";
    for (const std::string_view word : words_of(part)) set(measured, index + std::string(word));
  }
  return measured;
}

struct Judged {
  std::string_view change;  ///< of the rule's cases
  Verdict verdict;
};
struct Rule {
  std::string_view ids;  ///< of claims that have the rule
  std::string_view measured;
  std::vector<Judged> judged;
};

using enum Verdict;

/// Measured numbers on either side of every threshold.
TEST(Claims, AreJudgedByTheirThresholds) {
  const std::string_view
      counts = "raw_mean=41 raw_deviation=19 reduced_mean=6.9 reduced_deviation=1.8 reduced_max=25 outside_taps=14|",
      costs = "points=1000 matrix=1.3e-3 reduced=5e-6 tensor=2e-6",
      depths = "at_0.35=1e-4 at_1=1e-4 | at_0.35=2e-4 at_1=2e-4",
      vibration = "velocity_variation=0.1 vibration_power=1e-5 force_reversals=6 | | |";
  const std::vector<Rule> rules = {
      {"V1", depths, {{"", reproduced}, {"1.at_1=1.9e-4", in_kind}, {"1.at_0.35=5e-4 1.at_1=9e-5", not_reproduced}}},
      {"V2", depths, {{"", reproduced}, {"1.at_1=9e-5", not_reproduced}}},
      {"B1b",
       "depth=1e-4 | depth=2e-4",
       {{"", reproduced}, {"1.depth=1.9e-4", in_kind}, {"1.depth=1e-4", not_reproduced}}},
      {"B5",
       "hands=4 original_averaging=2 shaped_stiffness=0",
       {{"", reproduced}, {"shaped_stiffness=1", in_kind}, {"original_averaging=0", not_reproduced}}},
      {"S1",
       "velocity_variation=0.6 vibration_power=0.36 force_reversals=0 diverges=0 | velocity_variation=0.1 "
       "vibration_power=0.01 | diverges=1 | diverges=0",
       {{"", reproduced},
        {"0.velocity_variation=0.1 0.vibration_power=0.01", in_kind},
        {"0.velocity_variation=0.1 0.vibration_power=0.01 2.velocity_variation=0.49 2.vibration_power=0.24 "
         "2.diverges=0",
         not_reproduced}}},
      {"T1",
       "raw_mean=40 raw_deviation=10 reduced_mean=1 reduced_deviation=0 reduced_max=1 outside_taps=1 |",
       {{"", reproduced}, {"1.reduced_mean=1.1 1.reduced_max=2", not_reproduced}}},
      // Published: raw 37.8 ± 17.7 and 34.1 ± 19.5, reduced 6.21 ± 1.7 and 5.5 ± 1.9, so near is within 3.7, 1.8, 0.71,
      // 0.2. The raw counts of one recording do not go with the reduced ones of the other.
      {"T2",
       counts,
       {{"", reproduced},
        {"1.outside_taps=15", in_kind},
        {"1.reduced_mean=7", in_kind},
        {"reduced_deviation=3.1", in_kind},
        {"reduced_mean=7", not_reproduced},
        {"raw_mean=42", not_reproduced},
        {"raw_deviation=22", not_reproduced},
        {"reduced_mean=4.9", not_reproduced}}},
      // Published: raw 231.5 ± 116.1 and 163.7 ± 103.1, reduced 6.5 ± 2.1 and 5.2 ± 1.7, below 15.
      {"T3",
       "raw_mean=200 raw_deviation=110 reduced_mean=6 reduced_deviation=2 reduced_max=14 outside_taps=14",
       {{"", reproduced}, {"outside_taps=15", in_kind}, {"raw_mean=50", not_reproduced}}},
      {"T2b", "force=0.2 raw=55 kept=20 | force=1.9 raw=56", {{"", holds}, {"0.raw=56 1.raw=57", does_not_hold}}},
      {"T4", costs, {{"", reproduced}, {"matrix=3e-4", in_kind}, {"reduced=6e-4", not_reproduced}}},
      {"T4b", costs, {{"", holds}, {"tensor=6e-4", does_not_hold}}},
      {"T5",
       "points=500 reduced_0=0.015 reduced_3=0.02 unreduced_3=0.5 tensor_reduced_3=0.01 tensor_unreduced_3=0.005",
       {{"", reproduced},
        {"reduced_0=0.005", in_kind},
        {"unreduced_3=0.01", in_kind},
        {"reduced_0=0.005 unreduced_3=0.01", not_reproduced}}},
      {"R1 R3",
       "inside=1 min=0.7 max=1.2 any_max=1.4 | inside=0.96",
       {{"", reproduced},
        {"1.inside=0.94", in_kind},
        {"1.inside=0.49", not_reproduced},
        {"any_max=1.51", not_reproduced}}},
      {"R1b", "last_max=1.005 limit_max=1.009", {{"", reproduced}, {"last_max=1.3 limit_max=1.3", refuted}}},
      {"R2",
       "1: lambda_max=1.366 sets=100 | limit: lambda_max=1.36",
       {{"", reproduced}, {"1.lambda_max=1.51", not_reproduced}}},
      {"L1",
       "deviation=0.01 onset=2.75 plateau_spread=0.01",
       {{"", reproduced},
        {"onset=2", in_kind},
        {"onset=inf plateau_spread=0.5", not_reproduced},
        {"deviation=0.03", not_reproduced}}},
      {"L2",
       "rows=100 against=0.96 uphill=0.1 |",
       {{"", reproduced},
        {"0.against=0.94", in_kind},
        {"against=0.94", not_reproduced},
        {"against=nan", not_reproduced}}},  // no such row: nothing is shown
      {"L3",
       "frequency=2 mass=0.1 mass_unlimited=0.1 force=0.5 | frequency=4 mass=0.7 force=20",
       {{"", reproduced}, {"0.mass=0.12", in_kind}, {"0.force=2.1", in_kind}, {"1.mass=0.15", not_reproduced}}},
      {"L4", "off=1e4 on=2e4", {{"", reproduced}, {"on=1.9e4", in_kind}, {"on=1e4", not_reproduced}}},
      // Published: 0.25 mm, both; "around" is 0.3 mm.
      {"J1",
       "force=0.2 height=-2.9e-4 lateral=2e-4 inside=1e-4 | force=2.5 height=-4e-4 lateral=2.9e-4 inside=2.9e-4 | | ",
       {{"", in_kind},
        {"1.lateral=3.1e-4", not_reproduced},
        {"1.height=-2e-4", not_reproduced},
        {"0.height=-3.1e-4", not_reproduced},
        {"1.inside=3.1e-4", not_reproduced}}},
      {"J2", "tilt=1.0472", {{"", reproduced}, {"tilt=1.0476", not_reproduced}}},
      {"A1",
       vibration,
       {{"0.velocity_variation=0.5 0.vibration_power=2.5e-4", reproduced},
        // Much more power, not as much more variation.
        {"0.velocity_variation=0.4 0.vibration_power=1e-3 2.velocity_variation=0.5 2.vibration_power=2.5e-4", in_kind},
        // The force turns to and fro as much more often.
        {"0.velocity_variation=0.11 0.vibration_power=1.1e-5 0.force_reversals=30", reproduced},
        {"0.force_reversals=30", not_reproduced},
        {"2.velocity_variation=0.5 2.vibration_power=2.5e-4", not_reproduced}}},
      {"B4",
       vibration,
       {{"2.velocity_variation=0.5 2.vibration_power=2.5e-4", reproduced},
        {"0.velocity_variation=0.4 0.vibration_power=1e-3 2.velocity_variation=0.4 2.vibration_power=1e-3", in_kind},
        {"0.velocity_variation=0.4 0.vibration_power=1e-3", not_reproduced}}},
      {"A2",
       "a: pairs=100 arrives=1 overshoot=1e-4 swings=2 signed=1 | b: | a: pairs=4 swings=9",
       {{"", reproduced}, {"1.swings=3 2.swings=1", in_kind}, {"0.arrives=0", not_reproduced}}},
      {"A3",
       "shaped_stiffness: pairs=100 arrives=1 overshoot=1e-4 swings=2 signed=1 | overshoot=1.09e-4 | a: | swings=7",
       {{"", reproduced},
        {"pairs=4", in_kind},
        {"3.swings=6", not_reproduced},
        {"2.swings=3 3.swings=20", not_reproduced},  // it fluctuates without the limits, too
        {"1.overshoot=1.11e-4", not_reproduced}}},
      {"A4",
       "K_max (B = 0): limit=1.616e6 | B_max (K = 0): limit=399",
       {{"", reproduced}, {"0.limit=1.76e6", not_reproduced}, {"1.limit=520", not_reproduced}}},
      {"A5", "there=560 alone=400", {{"", reproduced}, {"there=600", in_kind}, {"there=390", not_reproduced}}},
      {"A6", "most=1 bound=1.1", {{"", reproduced}, {"most=1.01", refuted}}},
      {"G1",
       "shortest_product=-1 normal_product=1",
       {{"", reproduced}, {"normal_product=0.9", in_kind}, {"shortest_product=1", not_reproduced}}},
      // 5 % of 0.25 mm are 12.5 µm.
      {"G1b",
       "contacts=100 depth_mean=1e-6 depth_95=1.3e-5 depth_max=5e-5 share=0.1 force=0.05 way=1.2e-5",
       {{"", reproduced},
        {"force=0.06", in_kind},
        {"force=0.06 way=1.3e-5 depth_95=1.2e-5", in_kind},
        {"force=0.06 way=1.3e-5", not_reproduced}}},
      {"G2",
       "normal_projection=1e-8 surface_normal=1e-9",
       {{"", reproduced}, {"normal_projection=9e-9", in_kind}, {"normal_projection=1e-9", not_reproduced}}},
      {"B1",
       "with_shortest_distance=-1 with_surface_normal=1",
       {{"", reproduced}, {"with_surface_normal=-1", in_kind}, {"with_shortest_distance=1", not_reproduced}}},
      {"B2",
       "given=0.7 groove_friction_original_averaging=0.3 | groove_friction_original_averaging=0",
       {{"", reproduced}}},
      // What does not swing is not under-damped.
      {"B2",
       "given=0.7 groove_friction_original_averaging=nan | groove_friction_original_averaging=0.3",
       {{"", in_kind}, {"1.groove_friction_original_averaging=0.36", not_reproduced}}},
      {"B3",
       "depth_before=21 depth_after=23 direction_product=-1",
       {{"", reproduced}, {"depth_after=22", in_kind}, {"direction_product=1", not_reproduced}}},
      {"C1",
       "reduced_max=1 unreduced_max=100 force_difference=0.5",
       {{"", reproduced},
        {"force_difference=0.01", in_kind},
        {"reduced_max=2", not_reproduced},
        {"unreduced_max=9", not_reproduced}}},
      {"C8", "apart=0", {{"", reproduced}, {"apart=0.01", not_reproduced}}},
      {"C2",
       "velocity_variation=0.2 vibration_power=1e-6 force_reversals=5 | velocity_variation=0.1 force_reversals=0",
       {{"", reproduced},
        {"0.force_reversals=0", in_kind},
        {"0.velocity_variation=0.19", in_kind},
        {"0.velocity_variation=0.1", not_reproduced}}},
      {"C7",
       "velocity_variation=0.19 vibration_power=1e-6 force_reversals=0 | velocity_variation=0.1",
       {{"", reproduced},
        {"0.velocity_variation=0.2", in_kind},
        {"0.velocity_variation=0.2 0.force_reversals=1", not_reproduced}}},
      {"C3",
       "depth=5e-4 radius=5e-4 force=0.05 one_wall_force=10",
       {{"", reproduced}, {"depth=1e-4", in_kind}, {"force=1", not_reproduced}}},
      {"P1",
       "shaped_stiffness: x40=0.05 x40_reduced=0.05 updates=3 | m = 1000: x40=0.06",
       {{"", reproduced},
        {"0.x40=0.06", in_kind},
        {"0.x40=0.06 0.x40_reduced=0.06 1.x40=0.05", in_kind},
        {"0.x40=0.06 0.x40_reduced=0.06", not_reproduced}}},
      {"C5",
       "1 N: force=1 lateral=1e-4 inside=1e-4 | 1 N, averaged: | 3.5 N: force=3.5 lateral=9e-4 | "
       "3.5 N, averaged: lateral=1e-4",
       {{"", reproduced}, {"0.lateral=1.3e-4", in_kind}, {"0.lateral=1.3e-4 0.inside=1.3e-4", not_reproduced}}},
      {"C6",
       "1: count=1 damping_ratio=0.1 | 4: count=4 damping_ratio=0.209",
       {{"", reproduced}, {"1.damping_ratio=0.1", not_reproduced}}},
      // Published of D1: rates 0.32 ± 0.09 and 0.97 ± 0.02, speeds 0.009 and 0.002 m/s; of D2: rates 0.64 ± 0.13 and
      // 0.63 ± 0.19, speeds 0.002 and 0.002, no difference.
      {"D1",
       "success rate: original=0.2,0.3,0.4 shaped=0.9,1,1 | "
       "speed: original=9e-3,8e-3,8.5e-3 shaped=2e-3,2e-3,2e-3",
       {{"", reproduced},
        {"1.original=1,1.1,0.9 1.shaped=2,2,2", in_kind},
        {"0.original=0.6,0.65,0.7", in_kind},
        {"0.original=0.5,0.6,0.4 0.shaped=0.6,0.4,0.5", not_reproduced},
        {"0.original=0.9,1,1 0.shaped=0.2,0.3,0.4", not_reproduced}}},
      {"D2",
       "success rate: original=0.5,0.6,0.4 shaped=0.6,0.4,0.5",
       {{"", reproduced},
        {"original=0.2,0.3,0.4 shaped=0.9,1,1", not_reproduced},
        {"original=0.1,0.2,0.15 shaped=0.12,0.1,0.2", not_reproduced}}},
      // Both would be printed as 0.002: no difference, though it is significant; and one that would not.
      {"D2",
       "success rate: original=0.5,0.6,0.4 shaped=0.6,0.4,0.5 | "
       "speed: original=1.6e-3,1.7e-3,1.65e-3 shaped=2.1e-3,2.2e-3,2.15e-3",
       {{"", reproduced}, {"1.shaped=3.1e-3,3.2e-3,3.15e-3", in_kind}}},
      // Completion times of D2: 6.09 ± 0.92 and 6.47 ± 1.17 s.
      {"D2",
       "success rate: original=0.5,0.6,0.4 shaped=0.6,0.4,0.5 | completion time: original=5,5.5,6 shaped=5.5,5,6",
       {{"", reproduced}, {"1.original=3.6,3.7,3.8 1.shaped=3.8,3.6,3.7", in_kind}}},
      // The rate of D3 is printed as 1.0: its last digit is a tenth.
      {"D3",
       "success rate: original=0,0,0.1 shaped=1,1,0.9 | speed: original=2.9e-2,3e-2,3.1e-2 shaped=2e-3,2e-3,2e-3",
       {{"", reproduced}, {"0.shaped=0.7,0.7,0.7", in_kind}, {"1.original=9e-3,8e-3,8.5e-3", in_kind}}},
      {"D4",
       "success rate: original=0.2,0.3,0.4 shaped=0.9,1,1 | speed: original=1.3e-2,1.4e-2,1.5e-2 shaped=2e-3,2e-3,2e-3",
       {{"", reproduced}}},
      // Published: 0.64 ± 0.13 → 0.32 ± 0.09 and 0.63 ± 0.19 → 0.97 ± 0.02.
      {"D7",
       "centre: original=0.6,0.7,0.8 shaped=0.6,0.7,0.8 | side: original=0.3,0.4,0.5 shaped=0.9,1,1",
       {{"", reproduced}, {"1.original=0,0,0", in_kind}, {"1.original=0.7,0.7,0.7", not_reproduced}}},
      {"D6",
       "offset: value=0.4e-3 original=0.9 shaped=1 | value=0.6e-3 original=0.1 | height: value=2e-3 | "
       "value=4e-3 original=0.9",
       {{"", reproduced}, {"2.original=0.2", in_kind}, {"1.original=0.2 2.original=0.2", not_reproduced}}},
      // A threshold further out than the published one; one that nobody can remove.
      {"D6",
       "offset: value=0.4e-3 original=0.9 shaped=1 | value=0.6e-3 original=0.5 | height: value=2e-3 | "
       "value=4e-3 original=0.9 | offset: value=0.7e-3 original=0",
       {{"", in_kind}, {"4.shaped=0", not_reproduced}}},
      {"F1",
       "step=7 step_shortest=0.3 pressed=8e-4 depth=8e-4 depth_shortest=5e-4",
       {{"", reproduced}, {"depth=5e-4", in_kind}, {"step=1", not_reproduced}}},
      {"F2",
       "energy_ratio=1 boosts=5,2,4 tandpasta=0.3 summation=0.2 shaped_stiffness=0.25",
       {{"", reproduced},
        {"boosts=5,1.9,4", in_kind},
        {"boosts=5,0.9,4", not_reproduced},
        {"energy_ratio=1.1", not_reproduced}}},
      {"F3 P2",
       "points=90 other=0.1 shaped=0.01",
       {{"", reproduced}, {"other=0.09", in_kind}, {"other=0.009", not_reproduced}}},
  };
  std::set<std::string> judged;
  for (const auto& [ids, text, cases] : rules) {
    for (const std::string_view id : words_of(ids)) {
      judged.emplace(id);
      for (const auto& [change, verdict] : cases) {
        Measured measured = cases_in(text);
        for (const std::string_view word : words_of(change)) set(measured, word);
        const Finding finding = claim(id).judge(measured, published());
        EXPECT_EQ(finding.verdict, verdict) << id << ", " << change << ": " << finding.measured << " / " << finding.why;
        EXPECT_FALSE(finding.why.empty()) << id;
      }
    }
  }
  for (const char* id : {"C4", "C9", "D5"}) {  // not for a simulation
    judged.emplace(id);
    const Finding finding = claim(id).finding({published(), {}, {}});
    EXPECT_EQ(finding.verdict, not_reproducible) << id;
    EXPECT_FALSE(finding.why.empty()) << id;
  }
  std::set<std::string> all;
  for (const Claim& c : all_claims()) EXPECT_TRUE(all.insert(c.id).second) << c.id << " twice";
  EXPECT_EQ(judged, all);
}

/// The rules' texts are written from the thresholds, so this is also a test of those.
TEST(Claims, AreThoseOfTheLedger) {
  const Json ledger = read_json(HAPBENCH_SCENARIOS "/../../results/reference/claims.json").at("claims");
  const std::vector<Claim> claims = all_claims();
  ASSERT_EQ(ledger.size(), claims.size());
  for (std::size_t i = 0; i < claims.size(); ++i) {
    EXPECT_EQ(ledger[i].at("id"), claims[i].id);
    EXPECT_EQ(ledger[i].at("claim"), claims[i].claim) << claims[i].id;
    EXPECT_EQ(ledger[i].at("published"), published().fill(claims[i].published)) << claims[i].id;
    EXPECT_EQ(ledger[i].at("rule"), published().fill(claims[i].rule)) << claims[i].id;
  }
}

}  // namespace
}  // namespace hapbench::claims_test
