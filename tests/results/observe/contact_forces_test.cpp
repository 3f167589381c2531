#include "results/observe/contact_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "results/observe/metrics.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::contact_forces_test {
namespace {

/// A row: its force along x, and whether the tool is in contact.
struct Row {
  double force = 0.0;
  bool in_contact = true;
};

constexpr double kDt = 0.01;  ///< [s], exact enough that 0.03 s are three rows

/// The rows' phases as a text: a, l or s each.
std::string phases(const SettlingRule& rule, const std::string& contact) {
  ContactForces observer(kDt, rule);
  std::string text;
  for (const char c : contact) text += "als"[static_cast<int>(observer.add(Vec3::Zero(), {}, c == '#'))];
  return text;
}

/// Through MetricsObserver, which tells the changes from row to row.
MetricsObserver forces_of(const std::vector<Row>& rows, const SettlingRule& rule) {
  const ContactBuffer none(1);
  MetricsObserver observer(kDt, {.settling = rule});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    StepRecord r = test::row(k, kDt * static_cast<double>(k), none);
    r.colliding = rows[k].in_contact ? 1 : 0;
    r.force.rendered = {rows[k].force, 0.0, 0.0};
    observer.on_step(r);
  }
  return observer;
}

// Known answers compare what is behind the filter with scipy's.
TEST(HighPass, SettledAtAConstantGivesExactlyZero) {
  HighPass filter(30.0, 2000.0);
  const Vec3 value(0.1, -1e3, 1.0 / 3.0);
  for (int k = 0; k < 10; ++k) filter.filter(k * value);  // a past in both sections, which settling forgets
  filter.settle_at(value);
  for (int k = 0; k < 100; ++k) ASSERT_EQ(filter.filter(value), Vec3::Zero());
}

TEST(JudgedRows, BeginAQuarterIntoTheContactOrWholePeriodsBeforeTheEnd) {
  const auto begin = [](double period) {
    JudgedRows rows(1000, period);
    EXPECT_FALSE(rows.begin());
    rows.touch(200);
    rows.touch(500);
    return rows.begin().value();
  };
  EXPECT_EQ(begin(0.0), 400u);
  EXPECT_EQ(begin(250.0), 500u) << "two periods begin at 400 or later";
  EXPECT_EQ(begin(600.0), 400u);
  EXPECT_EQ(begin(700.0), 400u) << "none does";
}

constexpr SettlingRule kThreeRows = {.from = {}, .time = 0.03};

/// How many of the metrics that take settled contact have a value.
std::ptrdiff_t settled_metrics(const MetricsObserver& observer) {
  constexpr const char* kNames[] = {"force_mean_in_contact_N",  "settled_force_max_N",    "force_step_p99_N",
                                    "settled_force_step_max_N", "force_rms_above_30Hz_N", "force_reversals_per_s"};
  return std::ranges::count_if(kNames, [&](const char* name) { return told(observer, name).has_value(); });
}

TEST(SettlingRule, OnlyALongTimeAwayMakesTheNextTouchTheBeginningOfALanding) {
  EXPECT_EQ(phases(kThreeRows, "..#######"), "aalllssss");
  EXPECT_EQ(phases(kThreeRows, "#####"), "lllss") << "in contact since the start";
  EXPECT_EQ(phases(kThreeRows, "####..####"), "lllsaassss");
  EXPECT_EQ(phases(kThreeRows, "####...####"), "lllsaaallls");
  EXPECT_EQ(phases(kThreeRows, "#..#..#"), "lllsaas") << "a bounce belongs to the landing as long as that lasts";
}

TEST(SettlingRule, WithAStartTakesAllBeforeForLanding) {
  EXPECT_EQ(phases({.from = 0.05, .time = 0.03}, "..#######"), "lllllssss");
  EXPECT_EQ(phases({.from = 0.0, .time = 0.03}, "##....##"), "ssaaaass");
}

TEST(SettlingRule, RoundsTimesToRows) {
  EXPECT_EQ(phases({.from = {}, .time = 0.0349}, "#####"), "lllss");
  EXPECT_EQ(phases({.from = {}, .time = 0.0251}, "#####"), "lllss");
  EXPECT_EQ(phases({.from = 0.0151, .time = 0.03}, "#####"), "llsss");
}

TEST(ContactForces, HaveNoValueBelowAPeriodOfTheHighPass) {
  // Three rows are 0.03 s, four 0.04 s.
  std::vector<Row> rows = {{9}, {9}, {9}, {1}, {1}, {1}};
  EXPECT_EQ(settled_metrics(forces_of(rows, kThreeRows)), 0);
  rows.push_back({1});
  EXPECT_EQ(settled_metrics(forces_of(rows, kThreeRows)), 6);
}

TEST(ContactForces, HaveNoValueWithoutSuchRows) {
  const MetricsObserver away = forces_of({{0, false}, {0, false}}, kThreeRows);
  EXPECT_FALSE(told(away, "landing_force_max_N") || told(away, "landing_force_step_max_N"));
  const MetricsObserver landing = forces_of({{0, false}, {4}}, kThreeRows);
  EXPECT_EQ(told(landing, "landing_force_step_max_N"), 4.0);
  EXPECT_EQ(settled_metrics(landing), 0);
  EXPECT_EQ(told(landing, "settled_s"), 0.0);
}

TEST(ContactForces, HaveNoVibrationAtASamplingRateOfSixtyHertz) {
  EXPECT_FALSE(vibration_filter(1.0 / 60.0));
  EXPECT_TRUE(vibration_filter(1.0 / 61.0));
}

TEST(ContactForces, AShortBreakOfContactVibratesAndALongOneStartsFromRest) {
  const SettlingRule from = {.from = 0.0, .time = 0.03};
  const auto with_break = [&](std::size_t rows_away) {
    std::vector<Row> rows(10, {1.0});
    rows.insert(rows.end(), rows_away, {0.0, false});
    rows.insert(rows.end(), 10, {1.0});
    return told(forces_of(rows, from), "force_rms_above_30Hz_N").value();
  };
  EXPECT_GT(with_break(2), 0.0);
  EXPECT_EQ(with_break(4), with_break(400));
}

/// A second trial begins like a first one: its first touch is a landing, and the force before counts no more.
TEST(ContactForces, OfSeveralTrialsAddUp) {
  ContactForces forces(kDt, kThreeRows);
  const auto add_trial = [&forces](double force) {
    forces.begin();
    for (int k = 0; k < 9; ++k) forces.add({force, 0.0, 0.0}, {k == 0 ? 0.0 : 1.0, false}, true);
  };
  add_trial(1.0);
  add_trial(3.0);
  MetricList list;
  Section section(list, "");
  forces.tell(section);
  EXPECT_EQ(number_of(list, "landings"), 2.0);
  EXPECT_EQ(number_of(list, "settled_s"), 12 * kDt);
  EXPECT_EQ(number_of(list, "force_mean_in_contact_N"), 2.0);
  EXPECT_EQ(number_of(list, "force_rms_above_30Hz_N"), 0.0);
}

/// The number as a histogram of nothing else has it.
double counted(double number) {
  MagnitudeHistogram histogram;
  histogram.add_square(number * number);
  return histogram.quantile(1.0);
}

// Every bin, at its lower edge and just below: the numbers that are furthest from its middle.
TEST(MagnitudeHistogram, ErrorOfEveryBinIsTheStatedOne) {
  double largest = 0.0;
  for (double edge = MagnitudeHistogram::kLeast; edge < MagnitudeHistogram::kMost; edge *= std::sqrt(33.0 / 32.0)) {
    for (const double number : {edge, std::nextafter(edge, 0.0) * (1.0 - 1e-12)}) {
      if (number < MagnitudeHistogram::kLeast) continue;
      largest = std::max(largest, std::abs(counted(number) / number - 1.0));
    }
  }
  EXPECT_LE(largest, MagnitudeHistogram::kRelativeError);
  EXPECT_GT(largest, 0.9 * MagnitudeHistogram::kRelativeError);
}

TEST(MagnitudeHistogram, TakesNumbersBeyondItsEndsAsZeroAndInfinity) {
  EXPECT_EQ(counted(0.0), 0.0);
  EXPECT_EQ(counted(0.9 * MagnitudeHistogram::kLeast), 0.0);
  EXPECT_EQ(counted(MagnitudeHistogram::kMost), std::numeric_limits<double>::infinity());
  EXPECT_EQ(counted(1e300), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace hapbench::contact_forces_test
