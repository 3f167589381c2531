#include "results/observe/contact_forces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "results/allocations/allocations.hpp"
#include "results/observe/metrics.hpp"
#include "sim/core/random.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::contact_forces_test {
namespace {

using Phase = ContactForceObserver::Phase;

/// A row: its force along x, and whether the tool is in contact.
struct Row {
  double force = 0.0;
  bool in_contact = true;
};

constexpr double kDt = 0.01;  ///< [s], exact enough that 0.03 s are three rows

/// The rows' phases as a text: a, l or s each.
std::string phases(const SettlingRule& rule, const std::string& contact) {
  ContactForceObserver observer(kDt, rule);
  std::string text;
  for (const char c : contact) text += "als"[static_cast<int>(observer.add(Vec3::Zero(), {}, c == '#'))];
  return text;
}

/// Through MetricsObserver, which tells the changes from row to row.
ContactForces forces_of(const std::vector<Row>& rows, const SettlingRule& rule, double dt = kDt) {
  const ContactBuffer none(1);
  MetricsObserver observer(dt, {.settling = rule});
  for (std::size_t k = 0; k < rows.size(); ++k) {
    StepRecord r = test::row(k, dt * static_cast<double>(k), none);
    r.colliding = rows[k].in_contact ? 1 : 0;
    r.force.rendered = {rows[k].force, 0.0, 0.0};
    observer.on_step(r);
  }
  return observer.metrics().contact;
}

constexpr SettlingRule kThreeRows = {.from = {}, .time = 0.03};

TEST(SettlingRule, ALandingIsTheSettlingTimeAfterAFirstTouch) {
  EXPECT_EQ(phases(kThreeRows, "..#######"), "aalllssss");
  EXPECT_EQ(phases(kThreeRows, "#####"), "lllss") << "in contact since the start";
}

TEST(SettlingRule, OnlyAsLongATimeAwayMakesTheNextTouchAFirstOne) {
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

// All numbers are small whole ones or halves: exact.
TEST(ContactForces, AreThoseOfLandingsAndOfSettledContactApart) {
  const ContactForces f =
      forces_of({{0, false}, {9}, {-3}, {1}, {1}, {3}, {-2}, {0, false}, {2}, {0, false}, {0, false}, {0, false}, {5}},
                kThreeRows);
  EXPECT_EQ(f.landings, 2u);
  EXPECT_EQ(f.landing_max(), 9.0);
  EXPECT_EQ(f.landing_step_max(), 12.0);
  // The rows with 1, 3, -2 and 2 N.
  EXPECT_EQ(f.settled_rows, 4u);
  EXPECT_EQ(f.settled, 4 * kDt);
  EXPECT_EQ(f.mean(), 8.0 / 4.0);
  EXPECT_EQ(f.max(), 3.0);
  EXPECT_EQ(f.step_max(), 5.0);
  EXPECT_EQ(f.reversals, 1u);
  EXPECT_EQ(f.reversals_per_second(), 1.0 / (4 * kDt));
}

TEST(ContactForces, HaveNoValueBelowAPeriodOfTheHighPass) {
  // Three rows are 0.03 s, four 0.04 s.
  const std::vector<Row> three = {{9}, {9}, {9}, {1}, {1}, {1}};
  const ContactForces few = forces_of(three, kThreeRows);
  EXPECT_EQ(few.settled_rows, 3u);
  EXPECT_FALSE(few.mean() || few.max() || few.step_max() || few.step_p99() || few.rms_above_cutoff() ||
               few.reversals_per_second());
  std::vector<Row> four = three;
  four.push_back({1});
  const ContactForces enough = forces_of(four, kThreeRows);
  EXPECT_TRUE(enough.mean() && enough.max() && enough.step_max() && enough.step_p99() && enough.rms_above_cutoff() &&
              enough.reversals_per_second());
}

TEST(ContactForces, HaveNoValueWithoutSuchRows) {
  const ContactForces away = forces_of({{0, false}, {0, false}}, kThreeRows);
  EXPECT_FALSE(away.landing_max() || away.landing_step_max());
  const ContactForces landing = forces_of({{0, false}, {4}}, kThreeRows);
  EXPECT_EQ(landing.landing_max(), 4.0);
  EXPECT_EQ(landing.landing_step_max(), 4.0);
  EXPECT_FALSE(landing.mean() || landing.max() || landing.step_max() || landing.step_p99() ||
               landing.rms_above_cutoff() || landing.reversals_per_second());
  EXPECT_EQ(landing.settled, 0.0);
}

/// A contact that trembles, after a landing of a thousand newtons.
std::vector<Row> trembling(std::size_t rows, std::uint64_t seed) {
  Random random(seed);
  std::vector<Row> all = {{0, false}, {1000.0}};
  for (std::size_t k = 0; k < rows; ++k) all.push_back({1.0 + random.uniform(-0.1, 0.1)});
  return all;
}

TEST(ContactForces, TheP99IsNeverAboveTheLargestStep) {
  for (const double step : {1.0, 1.009, 1.02, 3e7}) {
    const ContactForces f = forces_of({{0}, {0}, {0}, {step}, {step}, {step}, {2.0 * step}}, kThreeRows);
    EXPECT_LE(*f.step_p99(), *f.step_max());
    EXPECT_NEAR(*f.step_p99(), step, MagnitudeHistogram::kRelativeError * step);
  }
}

TEST(ContactForces, TheBlowOfALandingDoesNotRingOnInTheVibration) {
  std::vector<Row> rows = {{0, false}, {1000}, {-200}, {30}};
  rows.insert(rows.end(), 50, {2.0});
  EXPECT_EQ(forces_of(rows, kThreeRows).rms_above_cutoff(), 0.0);
  rows.insert(rows.end(), 5, {0.0, false});
  rows.insert(rows.end(), {{500}, {-200}, {7}});
  rows.insert(rows.end(), 50, {1.0});
  const ContactForces f = forces_of(rows, kThreeRows);
  EXPECT_EQ(f.landings, 2u);
  EXPECT_EQ(f.rms_above_cutoff(), 0.0);
}

TEST(ContactForces, AShortBreakOfContactVibratesAndALongOneStartsFromRest) {
  const SettlingRule from = {.from = 0.0, .time = 0.03};
  const auto with_break = [&](std::size_t rows_away) {
    std::vector<Row> rows(10, {1.0});
    rows.insert(rows.end(), rows_away, {0.0, false});
    rows.insert(rows.end(), 10, {1.0});
    return *forces_of(rows, from).above_cutoff_squares;
  };
  EXPECT_GT(with_break(2), 0.0);
  EXPECT_EQ(with_break(4), with_break(400));
}

TEST(ContactForces, OfSeveralRunsAddUp) {
  const ContactForces first = forces_of(trembling(300, 1), kThreeRows),
                      second = forces_of(trembling(700, 2), kThreeRows);
  ContactForces both = first;
  both += second;
  EXPECT_EQ(both.landings, 2u);
  EXPECT_EQ(both.landing_max(), 1000.0);
  EXPECT_EQ(both.settled_rows, first.settled_rows + second.settled_rows);
  EXPECT_EQ(both.mean(), (first.sum + second.sum) / static_cast<double>(both.settled_rows));
  EXPECT_EQ(both.step_max(), std::max(first.step_max(), second.step_max()));
  EXPECT_EQ(both.rms_above_cutoff(), std::sqrt((*first.above_cutoff_squares + *second.above_cutoff_squares) /
                                               static_cast<double>(both.settled_rows)));
  EXPECT_GT(*both.step_p99(), std::min(*first.step_p99(), *second.step_p99()) * 0.99);
  EXPECT_LT(*both.step_p99(), std::max(*first.step_p99(), *second.step_p99()) * 1.01);
}

TEST(ContactForces, AreObservedWithoutAllocating) {
  const std::size_t before = heap_allocations();
  ContactForceObserver observer(kDt, kThreeRows);
  for (int k = 0; k < 1000; ++k) observer.add({1.0, 0.0, 0.1 * k}, {0.01, false}, k % 7 != 0);
  EXPECT_EQ(heap_allocations(), before);
  EXPECT_GT(observer.forces().settled_rows, 0u);
}

MagnitudeHistogram histogram_of(const std::vector<double>& numbers) {
  MagnitudeHistogram histogram;
  for (const double number : numbers) histogram.add_square(number * number);
  return histogram;
}

/// Numbers spread evenly over the exponents from 1e-8 to 1e5.
std::vector<double> many_numbers() {
  Random random(5);
  std::vector<double> numbers(20'000);
  for (double& number : numbers) number = std::pow(10.0, random.uniform(-8.0, 5.0));
  return numbers;
}

TEST(MagnitudeHistogram, GivesNearestRankQuantilesWithinItsError) {
  std::vector<double> numbers = many_numbers();
  const MagnitudeHistogram histogram = histogram_of(numbers);
  std::sort(numbers.begin(), numbers.end());
  double largest = 0.0;
  for (const double p : {0.001, 0.1, 0.25, 0.5, 0.9, 0.99, 0.9999, 1.0}) {
    const auto rank = static_cast<std::size_t>(std::ceil(p * static_cast<double>(numbers.size())));
    const double exact = numbers[rank - 1];
    const double error = std::abs(histogram.quantile(p) / exact - 1.0);
    EXPECT_LE(error, MagnitudeHistogram::kRelativeError) << p;
    largest = std::max(largest, error);
  }
  EXPECT_GT(largest, 0.1 * MagnitudeHistogram::kRelativeError) << "the stated error is not far too large";
}

// Every bin, at its lower edge and just below: the numbers that are furthest from its middle.
TEST(MagnitudeHistogram, ErrorOfEveryBinIsTheStatedOne) {
  double largest = 0.0;
  for (double edge = MagnitudeHistogram::kLeast; edge < MagnitudeHistogram::kMost; edge *= std::sqrt(33.0 / 32.0)) {
    for (const double number : {edge, std::nextafter(edge, 0.0) * (1.0 - 1e-12)}) {
      if (number < MagnitudeHistogram::kLeast) continue;
      largest = std::max(largest, std::abs(histogram_of({number}).quantile(1.0) / number - 1.0));
    }
  }
  EXPECT_LE(largest, MagnitudeHistogram::kRelativeError);
  EXPECT_GT(largest, 0.9 * MagnitudeHistogram::kRelativeError);
}

TEST(MagnitudeHistogram, TakesNumbersBeyondItsEndsAsZeroAndInfinity) {
  EXPECT_EQ(histogram_of({0.0}).quantile(1.0), 0.0);
  EXPECT_EQ(histogram_of({0.9 * MagnitudeHistogram::kLeast}).quantile(1.0), 0.0);
  EXPECT_NEAR(histogram_of({MagnitudeHistogram::kLeast}).quantile(1.0), MagnitudeHistogram::kLeast,
              MagnitudeHistogram::kRelativeError * MagnitudeHistogram::kLeast);
  EXPECT_EQ(histogram_of({MagnitudeHistogram::kMost}).quantile(1.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(histogram_of({1e300}).quantile(1.0), std::numeric_limits<double>::infinity());
}

TEST(MagnitudeHistogram, OfSeveralSetsIsTheSumInAnyOrder) {
  const std::vector<double> numbers = many_numbers();
  const std::vector<double> first(numbers.begin(), numbers.begin() + 7000),
      second(numbers.begin() + 7000, numbers.end());
  MagnitudeHistogram forwards = histogram_of(first), backwards = histogram_of(second);
  forwards += histogram_of(second);
  backwards += histogram_of(first);
  for (const double p : {0.01, 0.5, 0.99}) {
    EXPECT_EQ(forwards.quantile(p), histogram_of(numbers).quantile(p));
    EXPECT_EQ(backwards.quantile(p), histogram_of(numbers).quantile(p));
  }
}

}  // namespace
}  // namespace hapbench::contact_forces_test
