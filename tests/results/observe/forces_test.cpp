#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "algorithms/registry.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "results/observe/contact_forces.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/metrics.hpp"
#include "tests/results/observing.hpp"
#include "tests/support/setting.hpp"

namespace hapbench::forces_test {
namespace {

using test::Setting;

/// Input of one step: the force along x [N], and whether the tool is in contact.
struct Row {
  double force = 0.0;
  bool in_contact = true;
};

constexpr double kDt = 0.01;  ///< time step [s]; despite rounding, 0.03 s count as three steps

/// Returns the phases of the steps as a text with a, l or s for each step (away, landing, settled).
std::string phases(const SettlingRule& rule, const std::string& contact) {
  ContactForces observer(kDt, rule);
  std::string text;
  for (const char c : contact) text += "als"[static_cast<int>(observer.add(Vec3::Zero(), {}, c == '#'))];
  return text;
}

/// Feeds the steps to a MetricsObserver, which computes the changes from step to step.
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

// Checks only the output after settle_at(). tests/known_answers compares the output of the filter with scipy.
TEST(HighPass, SettledAtAConstantGivesExactlyZero) {
  HighPass filter(30.0, 2000.0);
  const Vec3 value(0.1, -1e3, 1.0 / 3.0);
  // Filter other samples first. settle_at() must remove their effect on both biquads of the filter.
  for (int k = 0; k < 10; ++k) filter.filter(k * value);
  filter.settle_at(value);
  for (int k = 0; k < 100; ++k) ASSERT_EQ(filter.filter(value), Vec3::Zero());
}

TEST(EvaluationWindow, BeginAQuarterIntoTheContactOrWholePeriodsBeforeTheEnd) {
  const auto begin = [](double period) {
    EvaluationWindow rows(1000, period);
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

/// Returns the number of metrics of settled contact that have a value.
std::ptrdiff_t settled_metrics(const MetricsObserver& observer) {
  constexpr const char* kNames[] = {"force_mean_in_contact_N",  "settled_force_max_N",    "force_step_p99_N",
                                    "settled_force_step_max_N", "force_rms_above_30Hz_N", "force_reversals_per_s"};
  return std::ranges::count_if(kNames, [&](const char* name) { return reported(observer, name).has_value(); });
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
  // The period of the high-pass at 30 Hz is 0.033 s. Three settled steps are 0.03 s, four are 0.04 s.
  std::vector<Row> rows = {{9}, {9}, {9}, {1}, {1}, {1}};
  EXPECT_EQ(settled_metrics(forces_of(rows, kThreeRows)), 0);
  rows.push_back({1});
  EXPECT_EQ(settled_metrics(forces_of(rows, kThreeRows)), 6);
}

TEST(ContactForces, HaveNoValueWithoutSuchRows) {
  const MetricsObserver away = forces_of({{0, false}, {0, false}}, kThreeRows);
  EXPECT_FALSE(reported(away, "landing_force_max_N") || reported(away, "landing_force_step_max_N"));
  const MetricsObserver landing = forces_of({{0, false}, {4}}, kThreeRows);
  EXPECT_EQ(reported(landing, "landing_force_step_max_N"), 4.0);
  EXPECT_EQ(settled_metrics(landing), 0);
  EXPECT_EQ(reported(landing, "settled_s"), 0.0);
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
    return reported(forces_of(rows, from), "force_rms_above_30Hz_N").value();
  };
  EXPECT_GT(with_break(2), 0.0);
  EXPECT_EQ(with_break(4), with_break(400));
}

/// Checks that a second trial begins like a first trial: its first touch is a landing, and the last force of the first
/// trial does not count.
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
  forces.report(section);
  EXPECT_EQ(number_of(list, "landings"), 2.0);
  EXPECT_EQ(number_of(list, "settled_s"), 12 * kDt);
  EXPECT_EQ(number_of(list, "force_mean_in_contact_N"), 2.0);
  EXPECT_EQ(number_of(list, "force_rms_above_30Hz_N"), 0.0);
}

/// Returns the value that a histogram reports for `number`. The histogram contains no other number.
double counted(double number) {
  MagnitudeHistogram histogram;
  histogram.add_square(number * number);
  return histogram.quantile(1.0);
}

// Checks every bin at its lower edge and just below this edge, which are the numbers farthest from the middles of the
// bins.
TEST(MagnitudeHistogram, ErrorOfEveryBinIsTheStatedOne) {
  double largest = 0.0;
  for (double boundary = MagnitudeHistogram::kSmallest; boundary < MagnitudeHistogram::kLargest;
       boundary *= std::sqrt(33.0 / 32.0)) {
    for (const double number : {boundary, std::nextafter(boundary, 0.0) * (1.0 - 1e-12)}) {
      if (number < MagnitudeHistogram::kSmallest) continue;
      largest = std::max(largest, std::abs(counted(number) / number - 1.0));
    }
  }
  EXPECT_LE(largest, MagnitudeHistogram::kRelativeError);
  EXPECT_GT(largest, 0.9 * MagnitudeHistogram::kRelativeError);
}

TEST(MagnitudeHistogram, TakesNumbersBeyondItsEndsAsZeroAndInfinity) {
  EXPECT_EQ(counted(0.0), 0.0);
  EXPECT_EQ(counted(0.9 * MagnitudeHistogram::kSmallest), 0.0);
  EXPECT_EQ(counted(MagnitudeHistogram::kLargest), std::numeric_limits<double>::infinity());
  EXPECT_EQ(counted(1e300), std::numeric_limits<double>::infinity());
}

constexpr double kMeasuredDt = 0.001;

TEST(ForceFidelity, WhereNothingIsRenderedTheNormalIsTheMeasuredForces) {
  const ReferenceForce measured({{0.0, {0.3, 0, 2}}, {1.0, {0.3, 0, 2}}});
  ForceFidelityObserver observer(measured, kMeasuredDt, 1);
  observer.on_step({});
  EXPECT_NEAR(reported(observer, "force_error_normal_rms_N").value(),
              reported(observer, "reference_force_rms_N").value(), 1e-15);
  EXPECT_NEAR(reported(observer, "force_error_tangential_rms_N").value(), 0.0, 1e-15);
  EXPECT_EQ(reported(observer, "direction_rows"), 0.0);
}

TEST(ForceFidelity, FindsNoLagBeyondItsReach) {
  std::vector<Vec3> early, late;
  for (int k = 0; k < 3000; ++k) {
    early.push_back({0, 0, kMeasuredDt * k});
    late.push_back({0, 0, std::max(0.0, kMeasuredDt * (k - 500))});
  }
  EXPECT_FALSE(lag_between(early, std::vector<Vec3>(3000, Vec3(0, 0, 1)), kMeasuredDt, kMaxLag));
  EXPECT_FALSE(lag_between({}, {}, kMeasuredDt, kMaxLag));
  EXPECT_FALSE(lag_between(early, late, kMeasuredDt, kMaxLag)) << "0.5 s late";
}

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Records the largest exchanged energy, which is the scale of rounding errors.
class Turnover final : public Observer {
 public:
  explicit Turnover(const EnergyLedger& ledger) : ledger_(&ledger) {}
  void on_step(const StepRecord&) noexcept override {
    const EnergyBalance& b = ledger_->balance();
    for (const double part : {b.kinetic, b.stored, b.input, b.spring, b.damping, b.rotation}) {
      value = std::max(value, std::abs(part));
    }
  }
  double value = 0.0;

 private:
  const EnergyLedger* ledger_;
};

struct Accounts {
  EnergyBalance balance;
  double residual_max = 0.0, turnover = 0.0;
  double kinetic_at_start = 0.0, stored_at_start = 0.0;
};

/// Runs a simulation with the energy ledger. Returns the energies [J] after the first step and at the end.
Accounts keep_accounts(SimulationConfig config, SimulationParts parts) {
  EnergyLedger ledger(config.mass, config.dt, parts.motion->position_is_free(), parts.source->capacity(),
                      *config.integrator);
  Turnover turnover(ledger);
  Simulation simulation(config, std::move(parts), {&ledger, &turnover});
  simulation.step();
  Accounts accounts;
  accounts.kinetic_at_start = ledger.balance().kinetic;
  accounts.stored_at_start = ledger.balance().stored;
  simulation.run();
  accounts.balance = ledger.balance();
  accounts.residual_max = reported(ledger, "residual_max_J").value();
  accounts.turnover = turnover.value;
  return accounts;
}

/// Checks that the energy balance of a free run is closed: all energy is accounted for, except rounding errors. `limit`
/// is the force limit of an ideal device [N]; empty for no limit.
void expect_closed(const test::AnalyticScene& scene, const RenderingConfig& config, const IntegratorEntry& integrator,
                   std::optional<double> limit = {}) {
  SCOPED_TRACE(std::string(scene.name) + " " + config.algorithm + " " + integrator.info.name);
  const Setting setting = scene.setting();
  SimulationParts parts = test::free_run(setting, config);
  parts.hand = std::make_unique<ForceHand>(std::array<Profile, 3>{1.0, -2.0, 3.0});
  parts.device = std::make_unique<IdealDevice>(limit);
  SimulationConfig run = test::free_run_config(setting, config, 400);
  run.integrator = &integrator;
  const Accounts a = keep_accounts(run, std::move(parts));
  const EnergyBalance& b = a.balance;
  // Every step adds a few rounding errors of the exchanged energy. With integrators other than leapfrog, there are also
  // rounding errors of the energy `integration`.
  const double rounding =
      400 * 20 * kEpsilon * (a.turnover + (&integrator == &kLeapfrog ? 0.0 : std::abs(b.integration)));
  EXPECT_LE(a.residual_max, rounding);
  EXPECT_NEAR(b.hand + b.actuator, b.input, rounding);
  EXPECT_NEAR(b.kinetic + b.stored,
              a.kinetic_at_start + a.stored_at_start + b.input + b.damping + b.rotation + b.created + b.integration +
                  b.residual,
              rounding);
}

TEST(EnergyLedger, ClosesToRoundingForEveryAlgorithmAndEveryIntegrator) {
  for (const test::AnalyticScene& scene : test::analytic_scenes()) {
    for (const auto& algorithm : algorithms()) {
      RenderingConfig config = test::config_for(algorithm.info->name, scene);
      config.mu_s = 5.0;
      config.mu_f = 10.0;
      expect_closed(scene, config, kLeapfrog, 2.0);
    }
    for (const IntegratorEntry* integrator : kIntegrators)
      expect_closed(scene, test::config_for("shaped_stiffness", scene), *integrator);
  }
}

/// Checks a tool that rotates while the far end of the spring is fixed. The energy that the rotation stores is work of
/// the rotation and not created.
TEST(EnergyLedger, TurningTheToolPutsEnergyIntoTheSprings) {
  EnergyLedger ledger(1.0, 0.1, true, 1);
  ContactBuffer contacts(1);
  StepRecord record;
  record.rendered = &contacts;
  constexpr double kTorsion = 4.0;  // stiffness [N m] of a spring whose moment increases with the angle
  for (int k = 0; k <= 10; ++k) {
    const double angle = 0.1 * k;
    record.step = static_cast<std::uint64_t>(k);
    record.tool.pose.axis = {std::sin(angle), 0, -std::cos(angle)};  // rotates about -y
    record.springs.moment = {0, kTorsion * angle, 0};
    record.springs.energy = 0.5 * kTorsion * angle * angle;
    ledger.on_step(record);
  }
  EXPECT_NEAR(ledger.balance().rotation, 2.0, 1e-14);
  EXPECT_NEAR(ledger.balance().created, 0.0, 1e-14);
}

TEST(EnergyLedger, KeepsTheLargestEventsInOrder) {
  EnergyLedger ledger(1.0, 0.5, true, 1);
  ContactBuffer contacts(1);
  StepRecord record;
  record.rendered = &contacts;
  double energy = 0.0;
  for (int k = 0; k < 50; ++k) {
    energy += (k * 37) % 50;  // every step creates another amount; the amounts 0 … 49 are mixed
    record.step = static_cast<std::uint64_t>(k);
    record.springs.energy = energy;
    ledger.on_step(record);
  }
  const auto events = ledger.events();
  ASSERT_EQ(events.size(), EnergyLedger::kEvents);
  for (std::size_t i = 0; i < events.size(); ++i) EXPECT_EQ(events[i].created, 49.0 - static_cast<double>(i));
}

}  // namespace
}  // namespace hapbench::forces_test
